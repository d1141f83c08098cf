#include "server/kernels/scene_frame.h"

#include <utility>

#include "shared/base/check.h"

namespace macula::kernels {
namespace {

using scene::ScenePlan;
using scene::Step;

visibility::Options visibility_options(const ScenePlan& plan) {
  visibility::Options options;
  options.bvh = plan.use(Step::TriangleBvh);
  options.alpha_test = plan.use(Step::AlphaTest);
  return options;
}

shading::MaterialOptions material_options(const ScenePlan& plan) {
  return {plan.use(Step::Textures), plan.use(Step::SpecularLobe)};
}

lights::Options light_options(const ScenePlan& plan) {
  lights::Options options;
  options.area_lights = plan.use(Step::AreaLights);
  options.punctual = plan.use(Step::PunctualLights);
  return options;
}

lights::EnvironmentLight environment_of(const scene::Scene& scene, const ScenePlan& plan) {
  if (!plan.has(Step::Environment) || !scene.environment) return {};
  return lights::EnvironmentLight(*scene.environment);
}

}  // namespace

Result<std::shared_ptr<const SceneFrame>> SceneFrame::create(
    std::shared_ptr<const scene::Scene> scene, const ScenePlan& plan, SceneTime time) {
  MACULA_CHECK(scene != nullptr);
  scene::ScenePose pose = scene::pose_at(*scene, time);
  auto triangles = visibility::TriangleScene::create(*scene, pose, visibility_options(plan));
  if (!triangles) return base::forward(triangles);
  return std::shared_ptr<const SceneFrame>(
      new SceneFrame(std::move(scene), plan, std::move(pose), std::move(*triangles)));
}

Result<std::shared_ptr<const SceneFrame>> SceneFrame::create(
    std::shared_ptr<const scene::Scene> scene, SceneTime time) {
  MACULA_CHECK(scene != nullptr);
  const ScenePlan plan(scene::facts_of(*scene));
  return create(std::move(scene), plan, time);
}

SceneFrame::SceneFrame(std::shared_ptr<const scene::Scene> scene, const ScenePlan& plan,
                       scene::ScenePose pose,
                       std::shared_ptr<const visibility::TriangleScene> triangles)
    : scene_(std::move(scene)),
      plan_(plan),
      pose_(std::move(pose)),
      triangles_(std::move(triangles)),
      surfaces_(*scene_, pose_),
      materials_(*scene_, material_options(plan_)),
      lights_(*scene_, pose_, materials_, light_options(plan_)),
      environment_(environment_of(*scene_, plan_)) {}

}  // namespace macula::kernels
