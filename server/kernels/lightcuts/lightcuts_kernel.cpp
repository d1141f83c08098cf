#include "server/kernels/lightcuts/lightcuts_kernel.h"

#include "server/kernels/lightcuts/deferred.h"
#include "server/kernels/planes.h"
#include "server/kernels/ray/full.h"
#include "server/kernels/ray/ray_kernel.h"

namespace macula::kernels::lightcuts {
namespace {

Config without_shortcuts_where_exact(const Config& config) {
  Config exact = config;
  if (config.ray.mode == Mode::Fast) return exact;
  exact.sizes = CutSizes::Uniform;
  exact.denoise = Denoise::No, exact.stereo = StereoReuse::No;
  return exact;
}

/// Several samples a cell, or light apart from reflectance: kernel `ray`'s tiles with our cuts.
FrameReport render_by_ray(const FrameRequest& request, const SceneFrame& scene,
                          const Config& config, TileScheduler& scheduler, FrameBuffers& out) {
  LightPlan plan = plan_lights(request, scene, config, scheduler);
  prepare_buffers(request.views, out);
  if (plan.report.stopped) return plan.report;
  ray::Config settings = config.ray;
  settings.area_light_samples = config.most_nodes;
  FrameReport report = ray::render_full(request, scene, settings, scheduler, out,
                                        Audience::RankZero, plan.cut_nodes);
  report += plan.report;
  return report;
}

std::vector<std::string> shortcuts(const Config& config, const SceneFrame& scene,
                                   std::size_t views) {
  std::vector<std::string> taken = ray::shortcuts(scene);
  if (config.stereo == StereoReuse::Yes && views > 1)
    taken.emplace_back("light of the second view is the first's where both see a surface");
  if (config.denoise == Denoise::Yes) taken.emplace_back("light is smoothed along surfaces");
  if (config.source == LightSource::Reservoirs && !config.reservoirs.traces_neighbours) {
    taken.emplace_back("lights kept from the last frame are taken to be seen from where they were");
  }
  if (config.source == LightSource::Reservoirs && config.reservoirs.blends_colours) {
    taken.emplace_back("light kept from the last frame has the mean colour of what arrived there");
  }
  return taken;
}

}  // namespace

FrameReport LightcutsKernel::render(const FrameRequest& request, const SceneFrame& scene,
                                    History& history, TileScheduler& scheduler,
                                    FrameBuffers& out) const {
  const Config config = without_shortcuts_where_exact(config_);
  const bool one_sample = config.ray.samples_per_cell == 1 && (out.wanted & kLight) == 0;
  const bool deferred = config.denoise == Denoise::Yes || config.gloss == Gloss::Yes;
  if (config.sizes == CutSizes::Uniform && !(deferred && one_sample))
    return ray::RayKernel(config.ray).render(request, scene, history, scheduler, out);
  FrameReport report = one_sample ? render_deferred(request, scene, config, history, scheduler, out)
                                  : render_by_ray(request, scene, config, scheduler, out);
  if (!report.stopped) {
    report.stopped = fill_rate(request, scheduler, out) == scheduling::Outcome::Stopped;
  }
  if (config.ray.mode == Mode::Exact) return report;
  report.biased_shortcuts =
      one_sample ? shortcuts(config, scene, request.views.size()) : ray::shortcuts(scene);
  return report;
}

void LightcutsKernel::shade(std::span<const SurfacePoint> points, const SceneFrame& scene,
                            TileScheduler& scheduler, std::span<Rgb> out) const {
  ray::RayKernel(config_.ray).shade(points, scene, scheduler, out);
}

}  // namespace macula::kernels::lightcuts
