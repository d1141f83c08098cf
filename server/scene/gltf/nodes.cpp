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

/// A node's transform by its parts; those it does not give are neutral.
struct Parts {
  DVec3 translation{0.0};
  DQuat rotation{1.0, 0.0, 0.0, 0.0};
  DVec3 scale{1.0};

  DMat4 matrix() const {
    return glm::scale(glm::translate(DMat4{1.0}, translation) * glm::mat4_cast(rotation), scale);
  }
};

/// The rotation made unit where it has a direction.
Parts parts_of(const tinygltf::Node& node) {
  Parts parts;
  if (const auto& t = node.translation; t.size() == 3) parts.translation = {t[0], t[1], t[2]};
  if (const auto& r = node.rotation; r.size() == 4) {
    parts.rotation = DQuat(r[3], r[0], r[1], r[2]);
    parts.rotation /= glm::length(parts.rotation);
  }
  if (const auto& s = node.scale; s.size() == 3) parts.scale = {s[0], s[1], s[2]};
  return parts;
}

Result<DMat4> local_transform(const tinygltf::Node& node, const std::string& place) {
  if (node.matrix.size() == 16) return matrix_of(node.matrix, place);
  const Parts parts = parts_of(node);
  if (!std::isfinite(glm::length(parts.rotation))) {
    return base::bad_input("the rotation has no direction", place, "a unit quaternion x, y, z, w");
  }
  return parts.matrix();
}

/// The rigid part of a transform, for things that have a direction but no size: z stays, y as near
/// as it can.
Pose rigid_part(const DMat4& matrix) {
  const DVec3 back = normalize(DVec3(matrix[2]));
  const DVec3 right = normalize(cross(DVec3(matrix[1]), back));
  const DMat3 axes(right, cross(back, right), back);
  return {DVec3(matrix[3]), normalize(glm::quat_cast(axes))};
}

/// Where a node lies: below the nearest moving node above it, or in the world.
struct Frame {
  std::optional<Index> joint;
  DMat4 parent_from_node{1.0};   ///< parent: the joint, or the world
  DMat4 world_from_parent{1.0};  ///< at rest
};

class NodeImporter {
 public:
  NodeImporter(const Document& document, const std::map<int, NodeMotion>& motions,
               MeshImporter& meshes, Scene& scene, Warnings& warnings)
      : document_(document),
        motions_(motions),
        meshes_(meshes),
        scene_(scene),
        warnings_(warnings),
        reached_(document.model.nodes.size()),
        placement_(scene) {}

  Result<void> import_tree();

 private:
  struct Visit {
    int node;
    Frame above;
    std::size_t depth;
  };
  Result<std::vector<int>> roots() const;
  Result<void> visit(const Visit& visit);
  Result<Frame> frame_of(int index, const Frame& above, const std::string& place);
  Frame add_joint(const tinygltf::Node& node, const NodeMotion& motion, const Frame& above);
  Result<void> import_contents(const tinygltf::Node& node, const Frame& frame,
                               const std::string& place);
  Result<void> place_meshes(int mesh, const Frame& frame, const std::string& place);
  Result<void> import_camera(const tinygltf::Node& node, const Frame& frame,
                             const std::string& place);
  Result<void> import_light(int light, const Frame& frame, const std::string& place);

  const Document& document_;
  const std::map<int, NodeMotion>& motions_;
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
    pending_.push_back({*root, Frame{}, 1});
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
  const Result<Frame> frame = frame_of(visit.node, visit.above, place);
  if (!frame) return forward(frame);
  for (auto child = node->children.rbegin(); child != node->children.rend(); ++child) {
    pending_.push_back({*child, *frame, visit.depth + 1});
  }
  return import_contents(*node, *frame, place);
}

Result<Frame> NodeImporter::frame_of(int index, const Frame& above, const std::string& place) {
  const tinygltf::Node& node = document_.model.nodes[static_cast<std::size_t>(index)];
  const Result<DMat4> local = local_transform(node, place);
  if (!local) return forward(local);
  Frame frame = above;
  frame.parent_from_node = above.parent_from_node * *local;
  if (!is_finite(above.world_from_parent * frame.parent_from_node)) {
    return base::bad_input("the transform overflows", place,
                           "finite, moderate scales and translations");
  }
  const auto motion = motions_.find(index);
  if (motion == motions_.end()) return frame;
  if (node.matrix.size() == 16) {
    warnings_.add("a node with a matrix stands still, though an animation names it");
    return frame;
  }
  return add_joint(node, motion->second, above);
}

/// A node that moves becomes a joint; the still transforms between it and the joint above are its
/// base.
Frame NodeImporter::add_joint(const tinygltf::Node& node, const NodeMotion& motion,
                              const Frame& above) {
  const Parts rest = parts_of(node);
  Joint joint;
  joint.name = node.name;
  joint.parent = above.joint;
  joint.parent_from_base = above.parent_from_node;
  joint.translation = rest.translation;
  joint.rotation = rest.rotation;
  joint.scale = rest.scale;
  joint.translations = motion.translations;
  joint.rotations = motion.rotations;
  joint.scales = motion.scales;
  joint.period = motion.period;
  scene_.joints.push_back(std::move(joint));
  return {static_cast<Index>(scene_.joints.size() - 1), DMat4{1.0},
          above.world_from_parent * above.parent_from_node * rest.matrix()};
}

Result<void> NodeImporter::import_contents(const tinygltf::Node& node, const Frame& frame,
                                           const std::string& place) {
  if (node.skin >= 0) warnings_.add("skins are ignored: meshes keep their base shape");
  if (node.mesh >= 0) {
    if (const auto placed = place_meshes(node.mesh, frame, place); !placed) return placed;
  }
  if (node.camera >= 0) {
    if (const auto camera = import_camera(node, frame, place); !camera) return camera;
  }
  const auto extension = node.extensions.find("KHR_lights_punctual");
  if (extension == node.extensions.end() || !extension->second.IsObject()) return {};
  const tinygltf::Value& light = extension->second.Get("light");
  return import_light(light.IsNumber() ? light.GetNumberAsInt() : -1, frame, place);
}

Result<void> NodeImporter::place_meshes(int mesh, const Frame& frame, const std::string& place) {
  const auto meshes = meshes_.require(mesh);
  if (!meshes) return forward(meshes);
  for (const Index index : *meshes) {
    const Instance wanted{index, frame.parent_from_node, frame.joint};
    const auto placed = placement_.place(wanted, place, frame.world_from_parent);
    if (!placed) return placed;
  }
  return {};
}

Result<void> NodeImporter::import_camera(const tinygltf::Node& node, const Frame& frame,
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
  const Pose pose = rigid_part(frame.parent_from_node);
  if (!(fov > 0.0 && fov < std::numbers::pi) || !math::is_finite(pose.position) ||
      !std::isfinite(glm::length(pose.rotation))) {
    return base::bad_input("the camera has no view", place,
                           "yfov in (0, pi) and a node that keeps directions apart");
  }
  std::string name = !node.name.empty() ? node.name : camera->name;
  if (name.empty()) name = base::concat("camera ", scene_.cameras.size());
  scene_.cameras.push_back({std::move(name), pose, Radians{fov}, frame.joint});
  return {};
}

std::optional<LightKind> light_kind(const std::string& type) {
  if (type == "point") return LightKind::Point;
  if (type == "spot") return LightKind::Spot;
  if (type == "directional") return LightKind::Directional;
  return std::nullopt;
}

Result<void> NodeImporter::import_light(int index, const Frame& frame, const std::string& place) {
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
  const Pose pose = rigid_part(frame.parent_from_node);
  Light light{.kind = *kind, .position = pose.position, .joint = frame.joint};
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

Result<void> import_nodes(const Document& document, const std::map<int, NodeMotion>& motions,
                          MeshImporter& meshes, Scene& scene, Warnings& warnings) {
  return NodeImporter(document, motions, meshes, scene, warnings).import_tree();
}

}  // namespace macula::scene::gltf
