#include "server/kernels/scene_timeline.h"

#include <numeric>
#include <utility>

#include "shared/base/check.h"

namespace macula::kernels {
namespace {

using scene::ScenePlan;
using scene::Step;
using scene::StepUse;

visibility::Options visibility_options(const ScenePlan& plan) {
  visibility::Options options;
  options.bvh = plan.use(Step::TriangleBvh);
  options.alpha_test = plan.use(Step::AlphaTest);
  options.refit = plan.use(Step::Refit);
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

/// What of a scene's motion a plan carries out; the rest stays where it is at time 0.
scene::MovingParts planned_motion(const scene::Scene& scene, const ScenePlan& plan) {
  scene::MovingParts moving = scene::moving_parts(scene);
  if (!plan.has(Step::TopLevel)) moving.instances.clear();
  if (!plan.has(Step::TopLevel) || !plan.has(Step::Refit)) moving.meshes.clear();
  if (!plan.has(Step::MovingLights)) moving.lights.clear();
  return moving;
}

std::vector<scene::Index> all_indices(std::size_t count) {
  std::vector<scene::Index> all(count);
  std::iota(all.begin(), all.end(), scene::Index{0});
  return all;
}

scene::MovingParts planned_relighting(const scene::Scene& scene, const ScenePlan& plan,
                                      const scene::MovingParts& moving) {
  scene::MovingParts parts;
  switch (plan.use(Step::MovingLights)) {
    case StepUse::LeftOut:
      break;
    case StepUse::Used:
      parts.instances = moving.instances, parts.lights = moving.lights;
      break;
    case StepUse::Forced:
      parts.instances = all_indices(scene.instances.size());
      parts.lights = all_indices(scene.lights.size());
      break;
  }
  return parts;
}

std::unique_ptr<const FieldRays> field_rays(const scene::Scene& scene, const ScenePlan& plan,
                                            SceneTime time) {
  if (scene.field == nullptr || !plan.has(Step::DistanceField)) return nullptr;
  return std::make_unique<FieldRays>(*scene.field,
                                     std::chrono::duration<double>(time.since_start).count());
}

bool forces_motion(const ScenePlan& plan) {
  return plan.use(Step::TopLevel) == StepUse::Forced || plan.use(Step::Refit) == StepUse::Forced;
}

}  // namespace

Result<std::shared_ptr<SceneTimeline>> SceneTimeline::create(
    std::shared_ptr<const scene::Scene> scene, const ScenePlan& plan, BouncedLight bounced) {
  MACULA_CHECK(scene != nullptr);
  std::shared_ptr<SceneTimeline> made(
      new SceneTimeline(std::move(scene), plan, std::move(bounced)));
  if (const auto built = made->build(); !built) return base::forward(built);
  return made;
}

Result<std::shared_ptr<SceneTimeline>> SceneTimeline::create(
    std::shared_ptr<const scene::Scene> scene) {
  MACULA_CHECK(scene != nullptr);
  const ScenePlan plan(scene::facts_of(*scene));
  return create(std::move(scene), plan);
}

SceneTimeline::SceneTimeline(std::shared_ptr<const scene::Scene> scene, const ScenePlan& plan,
                             BouncedLight bounced)
    : still_(std::make_shared<const SceneFrame::Still>(
          SceneFrame::Still{scene, plan, shading::MaterialTable(*scene, material_options(plan)),
                            environment_of(*scene, plan)})),
      moving_(planned_motion(*scene, plan)),
      relighting_(planned_relighting(*scene, plan, moving_)),
      bounced_(std::move(bounced)),
      moves_(!moving_.none() || forces_motion(plan) ||
             plan.use(Step::MovingLights) == StepUse::Forced) {}

Result<void> SceneTimeline::build() {
  scene::ScenePose pose = scene::pose_at(scene(), {});
  const visibility::Options options = visibility_options(still_->plan);
  std::shared_ptr<const visibility::TriangleScene> triangles;
  if (!moving_.instances.empty() || forces_motion(still_->plan)) {
    auto made = visibility::MovingTriangles::create(scene(), moving_, pose, options);
    if (!made) return base::forward(made);
    moving_triangles_ = std::move(*made);
  } else {
    auto made = visibility::TriangleScene::create(scene(), pose, options);
    if (!made) return base::forward(made);
    triangles = std::move(*made);
  }
  const shading::SurfaceTable surfaces(scene(), pose);
  const lights::LightList lights(scene(), pose, still_->materials, light_options(still_->plan));
  Frame first(new SceneFrame(still_, std::move(pose), surfaces, lights));
  first->triangles_ = std::move(triangles);
  // The copied table still looks at the shapes of the pose it was made of.
  first->surfaces_.move(scene(), scene::moving_parts(scene()).instances, first->pose_);
  first->field_rays_ = field_rays(scene(), still_->plan, {});
  place_lights(*first);
  if (moves_) {
    pattern_ = std::move(first);
  } else {
    counters_ = {1, 1};
    newest_ = std::move(first);
  }
  return {};
}

Result<SceneTimeline::Frame> SceneTimeline::new_frame() {
  Frame frame(new SceneFrame(still_, pattern_->pose_, pattern_->surfaces_, pattern_->lights_));
  frame->surfaces_.move(scene(), scene::moving_parts(scene()).instances, frame->pose_);
  frame->placed_lights_ = pattern_->placed_lights_;
  if (moving_triangles_ == nullptr) {
    frame->triangles_ = pattern_->triangles_;
  } else {
    auto triangles = moving_triangles_->make(frame->pose_);
    if (!triangles) return base::forward(triangles);
    frame->triangles_ = frame->own_triangles_ = std::move(*triangles);
  }
  ++counters_.frames;
  return frame;
}

Result<SceneTimeline::Frame> SceneTimeline::idle_or_new_frame() {
  {
    const std::lock_guard lock(pool_->mutex);
    if (!pool_->idle.empty()) {
      Frame frame = std::move(pool_->idle.back());
      pool_->idle.pop_back();
      return frame;
    }
  }
  return new_frame();
}

Result<void> SceneTimeline::move(SceneFrame& frame, SceneTime time) {
  scene::repose(scene(), moving_, time, frame.pose_);
  frame.surfaces_.move(scene(), moving_.instances, frame.pose_);
  frame.lights_.move(scene(), relighting_, frame.pose_, still_->materials);
  if (scene().field != nullptr && scene().field->moves()) {
    frame.field_rays_ = field_rays(scene(), still_->plan, time);
  }
  if (frame.own_triangles_ != nullptr) {
    auto moved = moving_triangles_->move(*frame.own_triangles_, frame.pose_);
    if (!moved) return moved;
  }
  if (bounced_ || !relighting_.none()) place_lights(frame);
  return {};
}

/// Last: bounced light asks everything else of the frame.
void SceneTimeline::place_lights(SceneFrame& frame) const {
  if (!still_->plan.has(Step::LightTree)) return;
  const std::vector<lights::VirtualPointLight> bounced =
      bounced_ ? bounced_(frame) : std::vector<lights::VirtualPointLight>{};
  frame.placed_lights_.make(frame.lights_, bounced);
}

/// Read-only from here on; whoever reads it last puts it back.
std::shared_ptr<const SceneFrame> SceneTimeline::share(Frame frame) {
  return {frame.release(), [pool = pool_](const SceneFrame* done) {
            const std::lock_guard lock(pool->mutex);
            pool->idle.emplace_back(const_cast<SceneFrame*>(done));
          }};
}

Result<std::shared_ptr<const SceneFrame>> SceneTimeline::at(SceneTime time) {
  const std::lock_guard lock(mutex_);
  if (!moves_) return newest_;
  std::erase_if(living_, [](const auto& frame) { return frame.expired(); });
  for (const auto& frame : living_) {
    auto known = frame.lock();
    if (known != nullptr && known->time() == time) return newest_ = std::move(known);
  }
  newest_.reset();  // the next moment's frame, unless somebody still reads it
  auto frame = idle_or_new_frame();
  if (!frame) return base::forward(frame);
  if (const auto moved = move(**frame, time); !moved) {
    --counters_.frames;
    return base::forward(moved);
  }
  ++counters_.moments;
  newest_ = share(std::move(*frame));
  living_.push_back(newest_);
  return newest_;
}

SceneTimeline::Counters SceneTimeline::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

}  // namespace macula::kernels
