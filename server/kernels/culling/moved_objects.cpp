#include "server/kernels/culling/moved_objects.h"

#include <cstdint>
#include <vector>

#include "shared/math/pose.h"

namespace macula::kernels::culling {

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
  std::vector<std::uint32_t> mover_of(before.world_from_object.size() + 1, 0);  // by surface id
  for (const scene::InstanceMotion& motion : scene::motions_between(before, scene.pose())) {
    const auto now_from_then = scene::rigid_motion(motion.now_from_before);
    if (!now_from_then) continue;
    movers.then_from_now.push_back(math::inverse(*now_from_then));
    mover_of[motion.instance + 1] = static_cast<std::uint32_t>(movers.then_from_now.size());
  }
  if (movers.then_from_now.empty()) return movers;
  for (std::size_t i = 0; i < buffers.surface_id.size(); ++i)
    movers.of.pixels()[i] = mover_of[buffers.surface_id.pixels()[i]];
  return movers;
}

}  // namespace macula::kernels::culling
