#include "server/scene/animation.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "server/scene/field_scene.h"
#include "server/scene/keys.h"
#include "shared/base/check.h"

namespace macula::scene {
namespace {

DMat4 parent_from_joint(const Joint& joint, SceneTime time) {
  const double seconds = seconds_into(time, joint.period);
  const DVec3 translation =
      joint.translations.empty() ? joint.translation : value_at(joint.translations, seconds);
  const DQuat rotation =
      joint.rotations.empty() ? joint.rotation : value_at(joint.rotations, seconds);
  const DVec3 scale = joint.scales.empty() ? joint.scale : value_at(joint.scales, seconds);
  const DMat3 turned = glm::mat3_cast(rotation);
  DMat4 base_from_joint(DMat3(turned[0] * scale.x, turned[1] * scale.y, turned[2] * scale.z));
  base_from_joint[3] = DVec4(translation, 1.0);
  return joint.parent_from_base * base_from_joint;
}

/// Whether a track turns the joint or one it hangs from.
std::vector<bool> joints_that_move(const Scene& scene) {
  std::vector<bool> moves(scene.joints.size());
  for (std::size_t i = 0; i < moves.size(); ++i) {
    const Joint& joint = scene.joints[i];
    moves[i] = joint.has_tracks() || (joint.parent && moves[*joint.parent]);
  }
  return moves;
}

template <class Part, class Moves>
std::vector<Index> indices_of(const std::vector<Part>& parts, const Moves& moves) {
  std::vector<Index> result;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (moves(parts[i])) result.push_back(static_cast<Index>(i));
  }
  return result;
}

std::vector<Vec3> blend(const std::vector<std::vector<Vec3>>& keys, const KeySpan& span,
                        std::vector<Vec3> reuse) {
  const std::vector<Vec3>& from = keys[span.before];
  const std::vector<Vec3>& to = keys[span.after];
  const auto u = static_cast<float>(span.u);
  reuse.resize(from.size());
  for (std::size_t i = 0; i < from.size(); ++i) reuse[i] = from[i] + u * (to[i] - from[i]);
  return reuse;
}

void reshape(const Deformation& deformation, SceneTime time, MeshShape& shape) {
  const KeySpan span = locate(deformation.times_s, seconds_into(time, deformation.period));
  shape.positions = blend(deformation.positions, span, std::move(shape.positions));
  if (deformation.normals.empty()) return;
  shape.normals = blend(deformation.normals, span, std::move(shape.normals));
  for (Vec3& normal : shape.normals) {
    const float length = glm::length(normal);
    if (length > 0.0F) normal /= length;
  }
}

DMat4 posed(const Instance& instance, const std::vector<DMat4>& world_from_joint) {
  return instance.joint ? world_from_joint[*instance.joint] * instance.parent_from_object
                        : instance.parent_from_object;
}

/// Into the world; all else of the two lights is the same.
void carry(const Light& light, const std::vector<DMat4>& world_from_joint, Light& moved) {
  const DMat4& world = world_from_joint[*light.joint];
  const DVec3& p = light.position;
  moved.position =
      DVec3(world[0]) * p.x + DVec3(world[1]) * p.y + DVec3(world[2]) * p.z + DVec3(world[3]);
  if (light.kind == LightKind::Point) return;
  const DVec3 direction = DMat3(world) * DVec3(light.direction);
  const double length = glm::length(direction);
  if (length > 0.0) moved.direction = Vec3(direction / length);
}

Light posed(const Light& light, const std::vector<DMat4>& world_from_joint) {
  Light moved = light;
  moved.joint.reset();
  if (light.joint) carry(light, world_from_joint, moved);
  return moved;
}

Pose posed(const Camera& camera, const std::vector<DMat4>& world_from_joint) {
  if (!camera.joint) return camera.parent_from_view;
  const DMat4& world = world_from_joint[*camera.joint];
  const DMat3 axes = DMat3(world) * glm::mat3_cast(camera.parent_from_view.rotation);
  const DVec3 back = glm::normalize(axes[2]);
  const DVec3 right = glm::normalize(glm::cross(axes[1], back));
  const DVec3 position(world * DVec4(camera.parent_from_view.position, 1.0));
  return {position, glm::normalize(glm::quat_cast(DMat3(right, glm::cross(back, right), back)))};
}

/// The field's point lights with keyframes; they come first among its scene's lights.
std::vector<Index> keyed_lights(const sdf::Field& field) {
  return indices_of(field.lights, [](const sdf::PointLight& light) {
    return light.position.track >= 0 || light.intensity.track >= 0;
  });
}

double field_seconds(SceneTime time) {
  return std::chrono::duration<double>(time.since_start).count();
}

/// A field's cameras follow its own keyframes, not joints.
void pose_field(const Scene& scene, ScenePose& pose) {
  pose.world_from_view.clear();
  for (const Camera& camera : field_cameras(*scene.field, field_seconds(pose.time)))
    pose.world_from_view.push_back(camera.parent_from_view);
}

void turn_joints(const Scene& scene, ScenePose& pose) {
  std::vector<DMat4>& world_from_joint = pose.world_from_joint;
  world_from_joint.clear();
  world_from_joint.reserve(scene.joints.size());
  for (const Joint& joint : scene.joints) {
    const DMat4 local = parent_from_joint(joint, pose.time);
    world_from_joint.push_back(joint.parent ? world_from_joint[*joint.parent] * local : local);
  }
}

}  // namespace

MovingParts moving_parts(const Scene& scene) {
  const std::vector<bool> moves = joints_that_move(scene);
  const auto carried = [&](const auto& part) { return part.joint && moves[*part.joint]; };
  const auto changes_shape = [](const Mesh& mesh) { return !mesh.deformation.empty(); };
  MovingParts parts;
  parts.instances = indices_of(scene.instances, [&](const Instance& instance) {
    return carried(instance) || changes_shape(scene.meshes[instance.mesh]);
  });
  parts.lights = indices_of(scene.lights, carried);
  parts.cameras = indices_of(scene.cameras, carried);
  parts.meshes = indices_of(scene.meshes, changes_shape);
  if (scene.field != nullptr && scene.field->moves()) {
    parts.field = true;
    parts.lights = keyed_lights(*scene.field);
  }
  return parts;
}

std::span<const Vec3> ScenePose::positions(const Scene& scene, Index mesh) const {
  return shapes[mesh].positions.empty() ? scene.meshes[mesh].positions : shapes[mesh].positions;
}

std::span<const Vec3> ScenePose::normals(const Scene& scene, Index mesh) const {
  return shapes[mesh].normals.empty() ? scene.meshes[mesh].normals : shapes[mesh].normals;
}

ScenePose pose_at(const Scene& scene, SceneTime time) {
  ScenePose pose;
  pose.time = time;
  turn_joints(scene, pose);
  const auto place_all = [&](const auto& parts, auto& placed) {
    placed.reserve(parts.size());
    for (const auto& part : parts) placed.push_back(posed(part, pose.world_from_joint));
  };
  place_all(scene.instances, pose.world_from_object);
  place_all(scene.cameras, pose.world_from_view);
  pose.shapes.resize(scene.meshes.size());
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    const Deformation& deformation = scene.meshes[i].deformation;
    if (!deformation.empty()) reshape(deformation, time, pose.shapes[i]);
  }
  if (scene.field != nullptr) pose_field(scene, pose);
  return pose;
}

void repose(const Scene& scene, const MovingParts& moving, SceneTime time, ScenePose& pose) {
  MACULA_DCHECK(pose.world_from_object.size() == scene.instances.size(), "a pose of this scene");
  pose.time = time;
  turn_joints(scene, pose);
  for (const Index i : moving.instances)
    pose.world_from_object[i] = posed(scene.instances[i], pose.world_from_joint);
  for (const Index i : moving.cameras)
    pose.world_from_view[i] = posed(scene.cameras[i], pose.world_from_joint);
  for (const Index i : moving.meshes) reshape(scene.meshes[i].deformation, time, pose.shapes[i]);
  if (moving.field) pose_field(scene, pose);
}

std::vector<Light> lights_at(const Scene& scene, const ScenePose& pose) {
  if (scene.field != nullptr) return field_lights(*scene.field, field_seconds(pose.time));
  std::vector<Light> lights;
  lights.reserve(scene.lights.size());
  for (const Light& light : scene.lights) lights.push_back(posed(light, pose.world_from_joint));
  return lights;
}

void carry_lights(const Scene& scene, std::span<const Index> which, const ScenePose& pose,
                  std::span<Light> lights) {
  if (scene.field != nullptr) {  // its lights have keyframes of their own instead of joints
    const std::vector<Light> now = field_lights(*scene.field, field_seconds(pose.time));
    for (const Index i : which) lights[i] = now[i];
    return;
  }
  constexpr std::size_t kAhead = 16;  // lights that the processor is told of in advance
  for (std::size_t k = 0; k < which.size(); ++k) {
    if (k + kAhead < which.size()) {
      __builtin_prefetch(&scene.lights[which[k + kAhead]]);
      __builtin_prefetch(&lights[which[k + kAhead]], 1);
    }
    const Light& light = scene.lights[which[k]];
    if (light.joint) carry(light, pose.world_from_joint, lights[which[k]]);
  }
}

std::vector<InstanceMotion> motions_between(const ScenePose& before, const ScenePose& now) {
  MACULA_CHECK(before.world_from_object.size() == now.world_from_object.size(),
               "poses of one scene");
  std::vector<InstanceMotion> motions;
  for (std::size_t i = 0; i < now.world_from_object.size(); ++i) {
    const DMat4& from = before.world_from_object[i];
    const DMat4& to = now.world_from_object[i];
    if (from == to || glm::determinant(DMat3(from)) == 0.0) continue;
    motions.push_back({static_cast<Index>(i), to * glm::affineInverse(from)});
  }
  return motions;
}

std::optional<Pose> rigid_motion(const DMat4& now_from_before) {
  constexpr double kTolerance = 1e-6;  // of lengths: rounding of float sources, far below a pixel
  const DMat3 linear(now_from_before);
  const DMat3 gram = glm::transpose(linear) * linear;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      const double expected = row == column ? 1.0 : 0.0;
      if (!(std::abs(gram[column][row] - expected) <= 2.0 * kTolerance)) return std::nullopt;
    }
  }
  if (glm::determinant(linear) < 0.0) return std::nullopt;
  return Pose{DVec3(now_from_before[3]), glm::normalize(glm::quat_cast(linear))};
}

}  // namespace macula::scene
