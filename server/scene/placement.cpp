#include "server/scene/placement.h"

#include <cmath>
#include <utility>

#include "shared/base/text.h"

namespace macula::scene {
namespace {

/// Below this the inverse has no digits left.
constexpr double kFlat = 1e-12;

/// Of the transformed unit cube, in that of the box of the same edges; negative when it mirrors.
double relative_volume(const DMat4& transform) {
  const DMat3 linear(transform);
  const double edges = glm::length(linear[0]) * glm::length(linear[1]) * glm::length(linear[2]);
  return edges > 0.0 ? glm::determinant(linear) / edges : 0.0;
}

}  // namespace

bool Placement::may_copy(Index mesh) {
  copied_ += scene_.meshes[mesh].triangles.size();
  return copied_ <= kMostCopied;
}

Result<void> Placement::place(const Instance& wanted, const std::string& place,
                              const DMat4& world_from_joint) {
  const double volume = relative_volume(wanted.parent_from_object);
  // A joint that is flat at rest (it grows from nothing) leaves the question to what hangs from it.
  const double joint_volume = relative_volume(world_from_joint);
  const bool flat = std::abs(volume) <= kFlat;
  const bool mirrors =
      !flat && (std::abs(joint_volume) > kFlat ? volume * joint_volume : volume) < 0.0;
  if ((flat || (mirrors && !mirrored_.contains(wanted.mesh))) && !may_copy(wanted.mesh)) {
    return base::bad_input("too many triangles lie under flattening or mirroring transforms", place,
                           base::concat("at most ", kMostCopied, "; apply them to the meshes"));
  }
  Instance placed = wanted;
  if (flat) {
    placed = {flattened(wanted), DMat4{1.0}, wanted.joint};
  } else if (mirrors) {
    placed.mesh = mirrored(wanted.mesh);
    placed.parent_from_object *= glm::scale(DMat4{1.0}, DVec3{-1.0, 1.0, 1.0});
  }
  scene_.instances.push_back(placed);
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
Index Placement::flattened(const Instance& wanted) {
  Mesh copy = scene_.meshes[wanted.mesh];
  for (Vec3& position : copy.positions)
    position = Vec3(DVec3(wanted.parent_from_object * DVec4(DVec3(position), 1.0)));
  copy.normals.clear();
  scene_.meshes.push_back(std::move(copy));
  return static_cast<Index>(scene_.meshes.size() - 1);
}

}  // namespace macula::scene
