#include "server/kernels/scene_frame.h"

#include <utility>

#include "server/kernels/scene_timeline.h"
#include "shared/base/check.h"

namespace macula::kernels {

Result<std::shared_ptr<const SceneFrame>> SceneFrame::create(
    std::shared_ptr<const scene::Scene> scene, const scene::ScenePlan& plan, SceneTime time) {
  const auto timeline = SceneTimeline::create(std::move(scene), plan);
  if (!timeline) return base::forward(timeline);
  return (*timeline)->at(time);
}

Result<std::shared_ptr<const SceneFrame>> SceneFrame::create(
    std::shared_ptr<const scene::Scene> scene, SceneTime time) {
  MACULA_CHECK(scene != nullptr);
  const scene::ScenePlan plan(scene::facts_of(*scene));
  return create(std::move(scene), plan, time);
}

}  // namespace macula::kernels
