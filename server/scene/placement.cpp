#include "server/scene/placement.h"

#include <cmath>
#include <utility>

#include "shared/base/text.h"

namespace macula::scene {

bool Placement::may_copy(Index mesh) {
  copied_ += scene_.meshes[mesh].triangles.size();
  return copied_ <= kMostCopied;
}

Result<void> Placement::place(Index mesh, const DMat4& world_from_object,
                              const std::string& place) {
  const DMat3 linear(world_from_object);
  const double volume = glm::determinant(linear);
  const double edges = glm::length(linear[0]) * glm::length(linear[1]) * glm::length(linear[2]);
  // Relative to the box of the same edges: below this, the inverse has no digits left.
  const bool flat = !(std::abs(volume) > 1e-12 * edges);
  const bool mirrors = !flat && volume < 0.0;
  if ((flat || (mirrors && !mirrored_.contains(mesh))) && !may_copy(mesh)) {
    return base::bad_input("too many triangles lie under flattening or mirroring transforms", place,
                           base::concat("at most ", kMostCopied, "; apply them to the meshes"));
  }
  if (flat) {
    scene_.instances.push_back({flattened(mesh, world_from_object), DMat4{1.0}});
  } else if (mirrors) {
    const DMat4 flip_x = glm::scale(DMat4{1.0}, DVec3{-1.0, 1.0, 1.0});
    scene_.instances.push_back({mirrored(mesh), world_from_object * flip_x});
  } else {
    scene_.instances.push_back({mesh, world_from_object});
  }
  return {};
}

/// The mesh reflected in x, its winding turned so that its front stays its front (glTF 2.0, 3.7.4).
Index Placement::mirrored(Index mesh) {
  if (const auto known = mirrored_.find(mesh); known != mirrored_.end()) return known->second;
  Mesh copy = scene_.meshes[mesh];
  for (Vec3& position : copy.positions) position.x = -position.x;
  for (Vec3& normal : copy.normals) normal.x = -normal.x;
  for (UVec3& triangle : copy.triangles) std::swap(triangle.y, triangle.z);
  scene_.meshes.push_back(std::move(copy));
  return mirrored_[mesh] = static_cast<Index>(scene_.meshes.size() - 1);
}

/// A transform that squeezes space to a plane has no inverse: the mesh is moved itself, shaded
/// flat.
Index Placement::flattened(Index mesh, const DMat4& world_from_object) {
  Mesh copy = scene_.meshes[mesh];
  for (Vec3& position : copy.positions)
    position = Vec3(DVec3(world_from_object * DVec4(DVec3(position), 1.0)));
  copy.normals.clear();
  scene_.meshes.push_back(std::move(copy));
  return static_cast<Index>(scene_.meshes.size() - 1);
}

}  // namespace macula::scene
