#include "server/kernels/culling/culling_kernel.h"

#include <utility>

#include "server/kernels/culling/keep_lights.h"
#include "server/kernels/culling/stage_clock.h"
#include "server/kernels/planes.h"
#include "server/kernels/ray/full.h"
#include "server/kernels/ray/ray_kernel.h"

namespace macula::kernels::culling {
namespace {

lights::VirtualLightTable table_of(const Config& config, const KeptLights& kept) {
  return {kept.lights, config.classes, static_cast<float>(kept.least_m)};
}

ray::Config lit_by(const Config& config, const lights::VirtualLightTable& table) {
  ray::Config lit = config.ray;
  lit.virtual_lights = {&table, config.asked, nullptr};
  return lit;
}

/// Puts calmed light in the place of what chance made.
void replace_light(ViewBuffers& view, const Plane<Rgb>& light) {
  const auto radiance = view.radiance.pixels();
  for (std::size_t i = 0; i < radiance.size(); ++i) {
    radiance[i] += (light.pixels()[i] - view.light.pixels()[i]) * view.reflectance.pixels()[i];
  }
}

void calm(const View& view, const Config& config, const ViewMemory* then, TileScheduler& scheduler,
          ViewBuffers& buffers, ViewMemory& now) {
  Plane<Rgb> light = config.blur_reach > 0
                         ? shared_light(view, buffers, config.blur_reach, scheduler)
                         : buffers.light;
  if (then != nullptr && config.newest < 1.0F)
    remember(view, buffers, *then, config.newest, scheduler, light);
  replace_light(buffers, light);
  now = {view.world_from_view, view.grid, buffers.depth_m, buffers.normal, std::move(light)};
}

void calm_all(const FrameRequest& request, const Config& config, CullingHistory& memory,
              TileScheduler& scheduler, FrameBuffers& out) {
  const bool remembers = memory.views.size() == request.views.size();
  std::vector<ViewMemory> now(request.views.size());
  for (std::size_t v = 0; v < request.views.size(); ++v) {
    calm(request.views[v], config, remembers ? &memory.views[v] : nullptr, scheduler, out.views[v],
         now[v]);
  }
  memory.views = std::move(now);
}

std::vector<std::string> shortcuts(const SceneFrame& scene, const Config& config) {
  std::vector<std::string> taken = ray::shortcuts(scene);
  taken.emplace_back(
      "indirect light ends after one diffuse bounce, and nearest to its source is capped");
  if (config.weights == CullWeights::None) taken.emplace_back("culled virtual lights are lost");
  if (config.blur_reach > 0)
    taken.emplace_back("cells share their area, ambient and indirect light with neighbours");
  if (config.newest < 1.0F) taken.emplace_back("these are averaged over frames");
  return taken;
}

}  // namespace

Config make_config(const KernelOptions& options) {
  Config config;
  config.ray = ray::make_config(options);
  config.indirect = options.bounces.value_or(1) > 0;
  return config;
}

FrameReport CullingKernel::render(const FrameRequest& request, const SceneFrame& scene,
                                  History& history, TileScheduler& scheduler,
                                  FrameBuffers& out) const {
  if (!config_.indirect)
    return ray::RayKernel(config_.ray).render(request, scene, history, scheduler, out);
  const bool exact = config_.ray.mode == Mode::Exact;
  CullingHistory forgotten;
  CullingHistory& memory = exact ? forgotten : record_of<CullingHistory>(history);
  const KeptLights kept = keep_lights(request, scene, config_, memory, scheduler);
  const lights::VirtualLightTable table = table_of(config_, kept);
  const unsigned wanted =
      std::exchange(out.wanted, exact ? out.wanted : out.wanted | kLight | kNormal);
  prepare_buffers(request.views, out);
  FrameReport report = kept.report;
  memory.made = kept.made, memory.kept = kept.lights.size(), memory.stages = kept.stages;
  StageClock clock;
  if (!report.stopped)
    report += ray::render_full(request, scene, lit_by(config_, table), scheduler, out);
  memory.stages.shading_ms = clock.lap_ms();
  if (!report.stopped && !exact) calm_all(request, config_, memory, scheduler, out);
  memory.stages.post_ms = clock.lap_ms();
  out.wanted = wanted;
  if (!report.stopped)
    report.stopped = fill_rate(request, scheduler, out) == scheduling::Outcome::Stopped;
  if (!exact) report.biased_shortcuts = shortcuts(scene, config_);
  return report;
}

void CullingKernel::shade(std::span<const SurfacePoint> points, const SceneFrame& scene,
                          TileScheduler& scheduler, std::span<Rgb> out) const {
  KeptLights all;
  if (config_.indirect) all = all_lights(scene, config_, 0, scheduler);
  const lights::VirtualLightTable table = table_of(config_, all);
  ray::RayKernel(lit_by(config_, table)).shade(points, scene, scheduler, out);
}

}  // namespace macula::kernels::culling
