#include "server/scene/gltf/nodes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "server/scene/placement.h"
#include "shared/base/text.h"

namespace macula::scene::gltf {
namespace {

bool is_finite(const DMat4& matrix) {
  for (int column = 0; column < 4; ++column) {
    if (!math::is_finite(DVec3(matrix[column])) || !std::isfinite(matrix[column].w)) return false;
  }
  return true;
}

Result<DMat4> matrix_of(const std::vector<double>& values, const std::string& place) {
  DMat4 matrix;
  for (std::size_t i = 0; i < 16; ++i)
    matrix[static_cast<int>(i / 4)][static_cast<int>(i % 4)] = values[i];
  // Exporters write floats: the last row is off by rounding at most.
  const DVec4 last_row(matrix[0].w, matrix[1].w, matrix[2].w, matrix[3].w - 1.0);
  if (!(glm::length(last_row) < 1e-5)) {
    return base::bad_input("the matrix is not affine", place, "its last row must be 0 0 0 1");
  }
  for (int column = 0; column < 4; ++column) matrix[column].w = column == 3 ? 1.0 : 0.0;
  return matrix;
}

Result<DMat4> local_transform(const tinygltf::Node& node, const std::string& place) {
  if (node.matrix.size() == 16) return matrix_of(node.matrix, place);
  DMat4 matrix{1.0};
  if (node.translation.size() == 3) {
    matrix =
        glm::translate(matrix, {node.translation[0], node.translation[1], node.translation[2]});
  }
  if (node.rotation.size() == 4) {
    const DQuat rotation(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]);
    const double length = glm::length(rotation);
    if (!(length > 0.0) || !std::isfinite(length)) {
      return base::bad_input("the rotation has no direction", place,
                             "a unit quaternion x, y, z, w");
    }
    matrix = matrix * glm::mat4_cast(rotation / length);
  }
  if (node.scale.size() == 3)
    matrix = glm::scale(matrix, {node.scale[0], node.scale[1], node.scale[2]});
  return matrix;
}

/// The rigid part of a transform, for things that have a direction but no size: z stays, y as near
/// as it can.
Pose rigid_part(const DMat4& matrix) {
  const DVec3 back = normalize(DVec3(matrix[2]));
  const DVec3 right = normalize(cross(DVec3(matrix[1]), back));
  const DMat3 axes(right, cross(back, right), back);
  return {DVec3(matrix[3]), normalize(glm::quat_cast(axes))};
}

class NodeImporter {
 public:
  NodeImporter(const Document& document, MeshImporter& meshes, Scene& scene, Warnings& warnings)
      : document_(document),
        meshes_(meshes),
        scene_(scene),
        warnings_(warnings),
        reached_(document.model.nodes.size()),
        placement_(scene) {}

  Result<void> import_tree();

 private:
  struct Visit {
    int node;
    DMat4 world_from_parent;
    std::size_t depth;
  };
  Result<std::vector<int>> roots() const;
  Result<void> visit(const Visit& visit);
  Result<void> import_contents(const tinygltf::Node& node, const DMat4& world_from_node,
                               const std::string& place);
  Result<void> place_meshes(int mesh, const DMat4& world_from_node, const std::string& place);
  Result<void> import_camera(const tinygltf::Node& node, const DMat4& world_from_node,
                             const std::string& place);
  Result<void> import_light(int light, const DMat4& world_from_node, const std::string& place);

  const Document& document_;
  MeshImporter& meshes_;
  Scene& scene_;
  Warnings& warnings_;
  std::vector<bool> reached_;
  std::vector<Visit> pending_;
  Placement placement_;
};

Result<std::vector<int>> NodeImporter::roots() const {
  const tinygltf::Model& model = document_.model;
  if (!model.scenes.empty()) {
    const int index = std::max(model.defaultScene, 0);
    if (const tinygltf::Scene* scene = find(model.scenes, index)) return scene->nodes;
    return base::bad_input(base::concat("there is no scene ", index), document_.path,
                           base::concat("there are ", model.scenes.size()));
  }
  std::vector<bool> is_child(model.nodes.size());
  for (const tinygltf::Node& node : model.nodes) {
    for (const int child : node.children) {
      if (find(model.nodes, child)) is_child[static_cast<std::size_t>(child)] = true;
    }
  }
  std::vector<int> result;
  for (std::size_t i = 0; i < is_child.size(); ++i) {
    if (!is_child[i]) result.push_back(static_cast<int>(i));
  }
  return result;
}

Result<void> NodeImporter::import_tree() {
  const auto first = roots();
  if (!first) return forward(first);
  for (auto root = first->rbegin(); root != first->rend(); ++root)
    pending_.push_back({*root, DMat4{1.0}, 1});
  while (!pending_.empty()) {
    const Visit next = pending_.back();
    pending_.pop_back();
    if (const auto visited = visit(next); !visited) return visited;
  }
  return {};
}

Result<void> NodeImporter::visit(const Visit& visit) {
  const tinygltf::Node* node = find(document_.model.nodes, visit.node);
  if (!node) {
    return base::bad_input(base::concat("there is no node ", visit.node), document_.path,
                           base::concat("there are ", document_.model.nodes.size()));
  }
  const auto index = static_cast<std::size_t>(visit.node);
  const std::string place = document_.place("node", index);
  if (reached_[index]) {
    return base::bad_input("the node is reached twice", place,
                           "nodes form a tree: no cycle, one parent each");
  }
  if (visit.depth > kMaxNodeDepth) {
    return base::bad_input("the node tree is too deep", place,
                           base::concat("at most ", kMaxNodeDepth, " levels"));
  }
  reached_[index] = true;
  const Result<DMat4> local = local_transform(*node, place);
  if (!local) return forward(local);
  const DMat4 world_from_node = visit.world_from_parent * *local;
  if (!is_finite(world_from_node)) {
    return base::bad_input("the transform overflows", place,
                           "finite, moderate scales and translations");
  }
  for (auto child = node->children.rbegin(); child != node->children.rend(); ++child) {
    pending_.push_back({*child, world_from_node, visit.depth + 1});
  }
  return import_contents(*node, world_from_node, place);
}

Result<void> NodeImporter::import_contents(const tinygltf::Node& node, const DMat4& world_from_node,
                                           const std::string& place) {
  if (node.skin >= 0) warnings_.add("skins are ignored: meshes keep their base shape");
  if (node.mesh >= 0) {
    if (const auto placed = place_meshes(node.mesh, world_from_node, place); !placed) return placed;
  }
  if (node.camera >= 0) {
    if (const auto camera = import_camera(node, world_from_node, place); !camera) return camera;
  }
  const auto extension = node.extensions.find("KHR_lights_punctual");
  if (extension == node.extensions.end() || !extension->second.IsObject()) return {};
  const tinygltf::Value& light = extension->second.Get("light");
  return import_light(light.IsNumber() ? light.GetNumberAsInt() : -1, world_from_node, place);
}

Result<void> NodeImporter::place_meshes(int mesh, const DMat4& world_from_node,
                                        const std::string& place) {
  const auto meshes = meshes_.require(mesh);
  if (!meshes) return forward(meshes);
  for (const Index index : *meshes) {
    if (const auto placed = placement_.place(index, world_from_node, place); !placed) return placed;
  }
  return {};
}

Result<void> NodeImporter::import_camera(const tinygltf::Node& node, const DMat4& world_from_node,
                                         const std::string& place) {
  const tinygltf::Camera* camera = find(document_.model.cameras, node.camera);
  if (!camera) {
    return base::bad_input(base::concat("there is no camera ", node.camera), place,
                           base::concat("there are ", document_.model.cameras.size()));
  }
  if (camera->type != "perspective") {
    warnings_.add("orthographic cameras are ignored");
    return {};
  }
  const double fov = camera->perspective.yfov;
  const Pose pose = rigid_part(world_from_node);
  if (!(fov > 0.0 && fov < std::numbers::pi) || !math::is_finite(pose.position) ||
      !std::isfinite(glm::length(pose.rotation))) {
    return base::bad_input("the camera has no view", place,
                           "yfov in (0, pi) and a node that keeps directions apart");
  }
  std::string name = !node.name.empty() ? node.name : camera->name;
  if (name.empty()) name = base::concat("camera ", scene_.cameras.size());
  scene_.cameras.push_back({std::move(name), pose, Radians{fov}});
  return {};
}

std::optional<LightKind> light_kind(const std::string& type) {
  if (type == "point") return LightKind::Point;
  if (type == "spot") return LightKind::Spot;
  if (type == "directional") return LightKind::Directional;
  return std::nullopt;
}

Result<void> NodeImporter::import_light(int index, const DMat4& world_from_node,
                                        const std::string& place) {
  const tinygltf::Light* from = find(document_.model.lights, index);
  if (!from) {
    return base::bad_input(base::concat("there is no light ", index), place,
                           base::concat("there are ", document_.model.lights.size()));
  }
  const auto kind = light_kind(from->type);
  if (!kind) {
    warnings_.add("lights of type '" + from->type + "' are ignored");
    return {};
  }
  const Pose pose = rigid_part(world_from_node);
  Light light{.kind = *kind, .position = pose.position};
  light.direction = Vec3(pose.transform_direction({0.0, 0.0, -1.0}));
  const Rgb color =
      from->color.size() == 3 ? Rgb(from->color[0], from->color[1], from->color[2]) : Rgb{1.0F};
  light.intensity = color * static_cast<float>(from->intensity);
  light.inner_cone = Radians{from->spot.innerConeAngle};
  light.outer_cone = Radians{from->spot.outerConeAngle};
  const bool cones = light.inner_cone.value() >= 0.0 && light.inner_cone < light.outer_cone &&
                     light.outer_cone.value() <= std::numbers::pi / 2.0;
  const bool finite = math::is_finite(light.intensity) && math::is_finite(light.direction);
  if (!finite || std::min({light.intensity.x, light.intensity.y, light.intensity.z}) < 0.0F ||
      (*kind == LightKind::Spot && !cones)) {
    return base::bad_input(
        "the light's values are out of range", place,
        "colour and intensity >= 0, cones 0 <= inner < outer <= pi / 2, scale not 0");
  }
  if (from->range > 0.0) warnings_.add("the range of lights is ignored: they reach everywhere");
  warnings_.add("candela and lux of lights are taken as W/sr and W/m^2");
  scene_.lights.push_back(light);
  return {};
}

}  // namespace

Result<void> import_nodes(const Document& document, MeshImporter& meshes, Scene& scene,
                          Warnings& warnings) {
  return NodeImporter(document, meshes, scene, warnings).import_tree();
}

}  // namespace macula::scene::gltf
