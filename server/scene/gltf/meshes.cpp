#include "server/scene/gltf/meshes.h"

#include <algorithm>
#include <numeric>
#include <optional>

#include "server/scene/gltf/accessor.h"
#include "shared/base/text.h"

namespace macula::scene::gltf {
namespace {

constexpr std::initializer_list<int> kFloat{TINYGLTF_COMPONENT_TYPE_FLOAT};
constexpr std::initializer_list<int> kFloatOrNormalised{TINYGLTF_COMPONENT_TYPE_FLOAT,
                                                        TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE,
                                                        TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT};
constexpr std::initializer_list<int> kUnsigned{TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE,
                                               TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT,
                                               TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT};

bool is_triangles(int mode) {
  return mode == TINYGLTF_MODE_TRIANGLES || mode == TINYGLTF_MODE_TRIANGLE_STRIP ||
         mode == TINYGLTF_MODE_TRIANGLE_FAN;
}

std::uint64_t triangle_count(int mode, std::uint64_t corners) {
  if (mode == TINYGLTF_MODE_TRIANGLES) return corners / 3;
  return corners < 3 ? 0 : corners - 2;
}

/// The corners of triangle `i` in the sequence of indices; glTF 2.0, section 3.7.2.1.
UVec3 corners_of(int mode, Index i) {
  switch (mode) {
    case TINYGLTF_MODE_TRIANGLE_STRIP:
      return {i, i + 1 + i % 2, i + 2 - i % 2};
    case TINYGLTF_MODE_TRIANGLE_FAN:
      return {i + 1, i + 2, 0};
    default:
      return {3 * i, 3 * i + 1, 3 * i + 2};
  }
}

/// The views of a primitive that were given, all of the same count except the indices.
struct Streams {
  std::optional<AccessorView> positions, normals, texcoords, indices;
  std::uint64_t corners() const { return indices ? indices->count() : positions->count(); }
};

Result<void> open(const Document& document, int accessor, const Expected& expected,
                  std::optional<AccessorView>& out) {
  auto view = AccessorView::create(document, accessor, expected);
  if (!view) return forward(view);
  out = *view;
  return {};
}

Result<Streams> open_streams(const Document& document, const tinygltf::Primitive& primitive,
                             const std::string& texcoord, const std::string& place) {
  Streams streams;
  Result<void> opened;
  const auto attribute = [&](const std::string& name, int type,
                             std::initializer_list<int> components,
                             std::optional<AccessorView>& out) {
    const auto found = primitive.attributes.find(name);
    if (!opened || found == primitive.attributes.end()) return;
    opened = open(document, found->second, {name.c_str(), type, components}, out);
    if (opened && streams.positions && out->count() != streams.positions->count()) {
      opened = base::bad_input(base::concat(name, " has ", out->count(), " elements"), place,
                               base::concat("as many as POSITION: ", streams.positions->count()));
    }
  };
  attribute("POSITION", TINYGLTF_TYPE_VEC3, kFloat, streams.positions);
  if (opened && !streams.positions) {
    return base::bad_input("there are no positions", place,
                           "give the primitive a POSITION attribute");
  }
  attribute("NORMAL", TINYGLTF_TYPE_VEC3, kFloat, streams.normals);
  attribute(texcoord, TINYGLTF_TYPE_VEC2, kFloatOrNormalised, streams.texcoords);
  if (opened && primitive.indices >= 0) {
    opened = open(document, primitive.indices, {"indices", TINYGLTF_TYPE_SCALAR, kUnsigned},
                  streams.indices);
  }
  if (!opened) return forward(opened);
  return streams;
}

/// The vertex of every corner, all in range.
Result<std::vector<Index>> read_corners(const Streams& streams, const std::string& place) {
  std::vector<Index> corners(streams.corners());
  if (!streams.indices) {
    std::iota(corners.begin(), corners.end(), Index{0});
    return corners;
  }
  const std::size_t vertices = streams.positions->count();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    corners[i] = streams.indices->index(i);
    if (corners[i] >= vertices) {
      return base::bad_input(base::concat("index ", i, " is ", corners[i]), place,
                             base::concat("there are ", vertices, " vertices"));
    }
  }
  return corners;
}

/// Which vertices to keep, ascending, and the corners renumbered to them. Exporters that share one
/// vertex buffer between many primitives would otherwise multiply it.
std::vector<Index> compact(std::vector<Index>& corners, std::size_t vertices) {
  std::vector<Index> kept;
  if (vertices <= 2 * corners.size()) {
    kept.resize(vertices);
    std::iota(kept.begin(), kept.end(), Index{0});
    return kept;
  }
  kept = corners;
  std::sort(kept.begin(), kept.end());
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  for (Index& corner : corners) {
    corner = static_cast<Index>(std::lower_bound(kept.begin(), kept.end(), corner) - kept.begin());
  }
  return kept;
}

Result<void> read_vertices(const Streams& streams, const std::vector<Index>& kept,
                           const std::string& place, Mesh& mesh) {
  const auto not_finite = [&place](const char* attribute, Index vertex) {
    return base::bad_input(base::concat(attribute, " of vertex ", vertex, " is not finite"), place,
                           "export again without NaN or infinite values");
  };
  for (const Index vertex : kept) {
    mesh.positions.push_back(streams.positions->vec3(vertex));
    if (!math::is_finite(mesh.positions.back())) return not_finite("POSITION", vertex);
    if (streams.normals) {
      mesh.normals.push_back(streams.normals->vec3(vertex));
      if (!math::is_finite(mesh.normals.back())) return not_finite("NORMAL", vertex);
    }
    if (streams.texcoords) {
      mesh.texcoords.push_back(streams.texcoords->vec2(vertex));
      if (!math::is_finite(Vec3{mesh.texcoords.back(), 0.0F}))
        return not_finite("TEXCOORD", vertex);
    }
  }
  return {};
}

/// Unit length, in double so that no length over- or underflows; false when one has no direction.
bool normalize_normals(std::vector<Vec3>& normals) {
  for (Vec3& normal : normals) {
    const double length = glm::length(DVec3(normal));
    if (!(length > 0.0)) return false;
    normal = Vec3(DVec3(normal) / length);
  }
  return true;
}

}  // namespace

Result<Index> MeshImporter::material_of(const tinygltf::Primitive& primitive,
                                        const std::string& place) const {
  if (primitive.material < 0) return materials_.fallback;
  if (static_cast<std::size_t>(primitive.material) >= document_.model.materials.size()) {
    return base::bad_input(base::concat("there is no material ", primitive.material), place,
                           base::concat("there are ", document_.model.materials.size()));
  }
  return static_cast<Index>(primitive.material);
}

Result<Mesh> MeshImporter::import_primitive(const tinygltf::Primitive& primitive,
                                            const std::string& place) {
  const Result<Index> material = material_of(primitive, place);
  if (!material) return forward(material);
  Mesh mesh;
  mesh.material = *material;
  const std::string texcoord = base::concat("TEXCOORD_", materials_.texcoord_sets[*material]);
  const Result<Streams> streams = open_streams(document_, primitive, texcoord, place);
  if (!streams) return forward(streams);

  const std::uint64_t count = triangle_count(primitive.mode, streams->corners());
  triangles_ += count;
  if (triangles_ > kMaxTriangles) {
    return base::bad_input("the scene has too many triangles", place,
                           base::concat("at most ", kMaxTriangles));
  }
  Result<std::vector<Index>> corners = read_corners(*streams, place);
  if (!corners) return forward(corners);
  const std::vector<Index> kept = compact(*corners, streams->positions->count());
  if (const auto read = read_vertices(*streams, kept, place, mesh); !read) return forward(read);
  if (!normalize_normals(mesh.normals)) {
    mesh.normals.clear();
    warnings_.add("normals of zero length: the mesh is shaded flat");
  }
  for (Index i = 0; i < count; ++i) {
    const UVec3 at = corners_of(primitive.mode, i);
    mesh.triangles.emplace_back((*corners)[at.x], (*corners)[at.y], (*corners)[at.z]);
  }
  return mesh;
}

Result<std::vector<Index>> MeshImporter::require(int mesh_index) {
  if (const auto known = imported_.find(mesh_index); known != imported_.end()) return known->second;
  const tinygltf::Mesh* from = find(document_.model.meshes, mesh_index);
  if (!from) {
    return base::bad_input(base::concat("a node names mesh ", mesh_index), document_.path,
                           base::concat("there are ", document_.model.meshes.size()));
  }
  std::vector<Index>& meshes = imported_[mesh_index];
  for (std::size_t i = 0; i < from->primitives.size(); ++i) {
    const tinygltf::Primitive& primitive = from->primitives[i];
    if (!is_triangles(primitive.mode)) {
      warnings_.add("points and lines are ignored");
      continue;
    }
    if (!primitive.targets.empty())
      warnings_.add("morph targets are ignored: meshes keep their base shape");
    if (primitive.attributes.contains("COLOR_0")) warnings_.add("colours of vertices are ignored");
    const std::string place = base::concat(
        document_.place("mesh", static_cast<std::size_t>(mesh_index)), " primitive ", i);
    Result<Mesh> mesh = import_primitive(primitive, place);
    if (!mesh) return forward(mesh);
    mesh->name = from->name;
    meshes.push_back(static_cast<Index>(scene_.meshes.size()));
    scene_.meshes.push_back(std::move(*mesh));
  }
  return meshes;
}

}  // namespace macula::scene::gltf
