#include "server/kernels/scene_frame.h"

#include <utility>

#include "shared/base/check.h"

namespace macula::kernels {

Result<std::shared_ptr<const SceneFrame>> SceneFrame::create(
    std::shared_ptr<const scene::Scene> scene, SceneTime time) {
  MACULA_CHECK(scene != nullptr);
  auto triangles = visibility::TriangleScene::create(*scene);
  if (!triangles) return base::forward(triangles);
  return std::shared_ptr<const SceneFrame>(
      new SceneFrame(std::move(scene), std::move(*triangles), time));
}

SceneFrame::SceneFrame(std::shared_ptr<const scene::Scene> scene,
                       std::shared_ptr<const visibility::TriangleScene> triangles, SceneTime time)
    : scene_(std::move(scene)),
      triangles_(std::move(triangles)),
      surfaces_(*scene_),
      materials_(*scene_),
      lights_(*scene_, materials_),
      time_(time) {}

}  // namespace macula::kernels
