// A scene at a moment: where its joints have carried instances, lights and cameras, and how its
// meshes have changed shape. Pure functions of (scene, time): the same time gives the same bits
// whichever came before. World space, meters. Source: glTF 2.0, appendix C (interpolation).
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "server/scene/scene.h"
#include "shared/base/result.h"

namespace macula::scene {

/// Seconds into tracks that repeat every `period` (0: never), for any 64-bit time; a period's
/// remainder is taken in whole nanoseconds, so that no digit is lost after years.
double seconds_into(SceneTime time, Nanoseconds period);

/// The track's value at `seconds`; the track is not empty.
DVec3 value_at(const Track<DVec3>& track, double seconds);
/// A unit quaternion.
DQuat value_at(const Track<DQuat>& track, double seconds);

/// What a scene's tracks reach, ascending; the rest stays where pose_at first puts it.
struct MovingParts {
  std::vector<Index> instances;  ///< carried by a joint or of a mesh that changes shape
  std::vector<Index> lights, cameras;
  std::vector<Index> meshes;  ///< that change shape
  bool field = false;         ///< a distance field with keyframes, its lights and cameras with it

  bool none() const {
    return instances.empty() && lights.empty() && cameras.empty() && meshes.empty() && !field;
  }
};
MovingParts moving_parts(const Scene& scene);

/// The vertices of a mesh that changes shape; both empty for a rigid one.
struct MeshShape {
  std::vector<Vec3> positions, normals;
};

struct ScenePose {
  SceneTime time;
  std::vector<DMat4> world_from_joint;   ///< by joint
  std::vector<DMat4> world_from_object;  ///< by instance
  std::vector<Pose> world_from_view;     ///< by camera
  std::vector<MeshShape> shapes;         ///< by mesh

  /// Of a mesh of the scene this is the pose of; object space.
  std::span<const Vec3> positions(const Scene& scene, Index mesh) const;
  std::span<const Vec3> normals(const Scene& scene, Index mesh) const;
};
ScenePose pose_at(const Scene& scene, SceneTime time);
/// Turns any pose of this scene into the one of `time`; touches only what moves.
void repose(const Scene& scene, const MovingParts& moving, SceneTime time, ScenePose& pose);

/// Every light of the scene where the pose has it: in the world, without joints.
std::vector<Light> lights_at(const Scene& scene, const ScenePose& pose);
/// Turns lights_at of any pose of this scene into those of `pose`; touches only those of `which`.
void carry_lights(const Scene& scene, std::span<const Index> which, const ScenePose& pose,
                  std::span<Light> lights);

/// How an instance moved between two moments, as a map of world points.
struct InstanceMotion {
  Index instance = 0;
  DMat4 now_from_before{1.0};
};
/// The instances whose transforms differ, ascending. One that had no volume before (scale 0) is
/// left out: nothing of it was to be seen. Changes of shape are not told.
std::vector<InstanceMotion> motions_between(const ScenePose& before, const ScenePose& now);
/// The motion as a rigid one, where lengths and angles stay within 1e-6 of themselves.
std::optional<Pose> rigid_motion(const DMat4& now_from_before);

/// A bound on how far anything of the scene is ever from the world's origin, over all keys of its
/// tracks and shapes; meters. Never too small; too large where turns and shifts do not add up.
double farthest_reach_m(const Scene& scene);

/// Tracks, joints and deformations keep their promises: sizes, order of times and of parents,
/// finite values, indices. The error names the joint or mesh.
Result<void> check_motion(const Scene& scene);

}  // namespace macula::scene
