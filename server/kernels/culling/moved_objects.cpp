#include "server/kernels/culling/moved_objects.h"

#include <unordered_map>

#include "shared/math/pose.h"

namespace macula::kernels::culling {
namespace {

/// By surface id.
using Motions = std::unordered_map<std::uint32_t, Pose>;

Motions rigid_motions(const scene::ScenePose& before, const scene::ScenePose& now) {
  Motions motions;
  for (const scene::InstanceMotion& motion : scene::motions_between(before, now)) {
    const auto now_from_then = scene::rigid_motion(motion.now_from_before);
    if (now_from_then) motions.emplace(motion.instance + 1, math::inverse(*now_from_then));
  }
  return motions;
}

}  // namespace

bool has_moving_objects(const SceneFrame& scene) {
  return !scene.scene().joints.empty() && !scene.scene().instances.empty();
}

scene::ScenePose places_of_objects(const SceneFrame& scene) {
  scene::ScenePose places;
  places.time = scene.time();
  places.world_from_object = scene.pose().world_from_object;
  return places;
}

reconstruction::Movers movers_in(const ViewBuffers& buffers, const scene::ScenePose& before,
                                 const SceneFrame& scene) {
  reconstruction::Movers movers;
  movers.of.resize(buffers.surface_id.width(), buffers.surface_id.height(), 0);
  if (before.world_from_object.size() != scene.pose().world_from_object.size()) return movers;
  const Motions motions = rigid_motions(before, scene.pose());
  if (motions.empty()) return movers;
  std::unordered_map<std::uint32_t, std::uint32_t> number;
  for (std::size_t i = 0; i < buffers.surface_id.size(); ++i) {
    const std::uint32_t id = buffers.surface_id.pixels()[i];
    const auto motion = motions.find(id);
    if (motion == motions.end()) continue;
    const auto next = static_cast<std::uint32_t>(movers.then_from_now.size() + 1);
    const auto [at, is_new] = number.try_emplace(id, next);
    if (is_new) movers.then_from_now.push_back(motion->second);
    movers.of.pixels()[i] = at->second;
  }
  return movers;
}

}  // namespace macula::kernels::culling
