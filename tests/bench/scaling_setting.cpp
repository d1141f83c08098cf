#include "tests/bench/scaling_setting.h"

#include <algorithm>
#include <cmath>

#include "server/kernels/registry.h"
#include "server/scene/load.h"
#include "tests/bench/lit_scene.h"
#include "tests/bench/ray_setting.h"

namespace macula::bench {
namespace {

struct Workload {
  const char* name;
  const char* kernel;
  const char* scene;
  void (*turn)(kernels::KernelOptions& options);
};

constexpr Workload kWorkloads[] = {
    {"ao16", "ray", "atrium",
     [](kernels::KernelOptions& options) { options.ambient_samples = 16; }},
    {"lightcuts", "lightcuts", "city",
     [](kernels::KernelOptions& options) { options.light_share = kernels::LightShare::Perceived; }},
    {"culling", "culling", "nave", [](kernels::KernelOptions&) {}},
    {"sphere", "sphere", "columns", [](kernels::KernelOptions&) {}},
};

const Workload* find_workload(const std::string& name) {
  const auto* found = std::ranges::find(kWorkloads, name, &Workload::name);
  return found == std::end(kWorkloads) ? nullptr : found;
}

/// An open sky and nothing else shines, as in the paper.
void leave_only_sky(scene::Scene& scene) {
  switch_off(scene);
  scene.settings.ambient = Rgb{1.0F};
  constexpr double kReach = 0.1;  // of the scene's diagonal: an interior is not all black
  scene.settings.ambient_distance_m =
      std::min(scene.settings.ambient_distance_m, kReach * glm::length(scene.bounds().size()));
}

}  // namespace

std::vector<std::string> ScalingSetting::workloads() {
  std::vector<std::string> names;
  for (const Workload& workload : kWorkloads) names.emplace_back(workload.name);
  return names;
}

std::string ScalingSetting::standard_scene(const std::string& workload) {
  const Workload* found = find_workload(workload);
  return found == nullptr ? "" : found->scene;
}

Result<std::unique_ptr<ScalingSetting>> ScalingSetting::create(const std::string& workload,
                                                               const std::string& scene,
                                                               int width_px, int height_px) {
  const Workload* found = find_workload(workload);
  if (found == nullptr)
    return base::bad_input("unknown kernel '" + workload + "'", "--kernels",
                           "allowed: ao16, lightcuts, culling, sphere");
  auto loaded = scene::load_scene(scene);
  if (!loaded) return base::forward(loaded);
  auto lit = std::make_shared<scene::Scene>(**loaded);
  if (workload == "ao16") leave_only_sky(*lit);
  if (auto fits = kernels::check_scene(found->kernel, *lit); !fits) return base::forward(fits);
  kernels::KernelOptions options;
  found->turn(options);
  auto kernel = kernels::make_kernel(found->kernel, options);
  if (!kernel) return base::forward(kernel);
  auto timeline = kernels::SceneTimeline::create(std::move(lit));
  if (!timeline) return base::forward(timeline);
  std::unique_ptr<ScalingSetting> setting(new ScalingSetting);
  setting->timeline_ = std::move(*timeline);
  setting->kernels_ = {std::shared_ptr<const kernels::Kernel>(std::move(*kernel))};
  setting->display_ = {
      math::symmetric_fov(Degrees{90.0}, static_cast<double>(width_px) / height_px), width_px,
      height_px};
  return setting;
}

std::vector<kernels::View> ScalingSetting::views_at(int frame, const StillGaze& gaze) const {
  constexpr double kRate_hz = 30.0, kEyes_m = 0.063;
  const Pose head = swayed(starting_pose(timeline_->scene()), frame / kRate_hz);
  const double yaw = Radians{gaze.yaw}.value(), pitch = Radians{gaze.pitch}.value();
  std::vector<kernels::View> views(2);
  for (std::size_t eye = 0; eye < views.size(); ++eye) {
    kernels::View& view = views[eye];
    view.world_from_view = head * Pose{{(static_cast<double>(eye) - 0.5) * kEyes_m, 0.0, 0.0}, {}};
    view.gaze.direction = Vec3{
        DVec3{std::sin(yaw) * std::cos(pitch), std::sin(pitch), -std::cos(yaw) * std::cos(pitch)}};
    view.grid = foveation::make_foveal_grid(display_, view.gaze, foveation::RateModel{});
    view.tone = timeline_->scene().settings.tone;
  }
  return views;
}

bool ScalingSetting::render(const kernels::Kernel& kernel, const StillGaze& gaze, int count,
                            scheduling::TileScheduler& scheduler) const {
  kernels::History history;
  kernels::FrameBuffers out;
  for (int frame = 0; frame < count; ++frame) {
    const auto views = views_at(frame, gaze);
    std::vector<FoveationMap::ViewInput> inputs;
    for (const kernels::View& view : views)
      inputs.push_back({view.grid, view.gaze, display_.pixel_tangent()});
    const FoveationMap map(std::move(inputs), foveation::RateModel{});
    const auto scene = timeline_->at(kernels::SceneTime{});
    if (!scene) return false;
    const kernels::FrameRequest request{views, map, static_cast<std::uint64_t>(frame), 1};
    if (kernel.render(request, **scene, history, scheduler, out).stopped) return false;
  }
  return true;
}

}  // namespace macula::bench
