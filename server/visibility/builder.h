// From a scene's meshes to Embree's geometries. Internal to this room; for one thread.
#pragma once

#include <map>
#include <span>
#include <vector>

#include "server/visibility/state.h"

namespace macula::visibility {

/// What of a structure changes after it is built.
enum class Change { Nothing, Instances, Vertices };

class Builder {
 public:
  /// The scene and the device must outlive the builder.
  Builder(const scene::Scene& scene, const Options& options, DeviceState& device);

  SceneHandle new_scene(Change change = Change::Nothing) const;
  /// The caller releases it once it is attached.
  RTCGeometry new_triangles(scene::Index mesh, std::span<const Vec3> positions,
                            const DMat4& transform, Change change);
  /// A mesh in a scene of its own, shared by its instances; lives as long as the builder or an
  /// instance of it.
  RTCScene child_of(scene::Index mesh, const scene::ScenePose& pose);

  /// Whether there is anything of the instance for a ray to meet.
  bool is_there(scene::Index instance) const;
  /// Whether the instance's triangles had better be copied into the world.
  bool goes_flat(scene::Index instance, const DMat4& world_from_object) const;
  /// An instance by its triangles, with its index as id. The geometry belongs to `into`.
  RTCGeometry add_flat(scene::Index instance, const scene::ScenePose& pose, RTCScene into,
                       SceneState& state, Change change = Change::Nothing);
  /// An instance of `child` in the top level, which it belongs to, with its index as id.
  RTCGeometry add_instance(scene::Index instance, RTCScene child, const DMat4& world_from_object,
                           SceneState& state) const;
  /// In all geometries made so far.
  std::size_t triangles_made() const { return triangles_made_; }

 private:
  void choose_copied(const std::vector<std::size_t>& uses);
  AlphaUse alpha_of(const scene::Mesh& mesh) const;
  FilteredMesh& filtered(scene::Index mesh);

  const scene::Scene& scene_;
  const Options options_;
  DeviceState& device_;
  const bool all_flat_;
  std::vector<bool> copied_;  ///< by mesh: its instances by their own triangles
  std::size_t triangles_made_ = 0;
  std::map<scene::Index, SceneHandle> children_;
};

/// How the scene is traced on the device, and nothing to trace yet.
std::unique_ptr<SceneState> new_state(const scene::Scene& scene, const Options& options,
                                      std::shared_ptr<const DeviceState> device);
/// Whether a structure is to be built at all.
bool wants_bvh(const scene::Scene& scene, const Options& options);
/// Every transform is finite. The error names the instance.
Result<void> check_transforms(const scene::Scene& scene, const scene::ScenePose& pose);

bool is_finite(const DMat4& matrix);
/// Keeps its digits as the float transform of an instance.
bool is_invertible(const DMat3& linear);
/// Takes object-space normals by winding to the front side in the world, at a positive scale, also
/// under mirroring.
DMat3 normal_matrix(const DMat3& linear);
void set_transform(RTCGeometry instance, const DMat4& transform);

}  // namespace macula::visibility
