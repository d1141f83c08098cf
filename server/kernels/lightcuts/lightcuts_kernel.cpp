#include "server/kernels/lightcuts/lightcuts_kernel.h"

#include "server/kernels/lightcuts/deferred.h"
#include "server/kernels/planes.h"
#include "server/kernels/ray/full.h"
#include "server/kernels/ray/ray_kernel.h"

namespace macula::kernels::lightcuts {
namespace {

/// Several samples a cell, or light apart from reflectance: kernel `ray`'s tiles with our cuts.
FrameReport render_by_ray(const FrameRequest& request, const SceneFrame& scene,
                          const Config& config, TileScheduler& scheduler, FrameBuffers& out) {
  LightPlan plan = plan_lights(request, scene, config, scheduler);
  prepare_buffers(request.views, out);
  if (plan.report.stopped) return plan.report;
  ray::Config settings = config.ray;
  settings.area_light_samples = config.most_nodes;
  FrameReport report = ray::render_full(request, scene, settings, scheduler, out, plan.cut_nodes);
  report += plan.report;
  return report;
}

}  // namespace

FrameReport LightcutsKernel::render(const FrameRequest& request, const SceneFrame& scene,
                                    History& history, TileScheduler& scheduler,
                                    FrameBuffers& out) const {
  const bool perceived = config_.sizes == CutSizes::Perceived && config_.ray.mode == Mode::Fast;
  if (!perceived)
    return ray::RayKernel(config_.ray).render(request, scene, history, scheduler, out);
  const bool by_ray = config_.ray.samples_per_cell > 1 || (out.wanted & kLight) != 0;
  FrameReport report = by_ray ? render_by_ray(request, scene, config_, scheduler, out)
                              : render_deferred(request, scene, config_, scheduler, out);
  if (!report.stopped) {
    report.stopped = fill_rate(request, scheduler, out) == scheduling::Outcome::Stopped;
  }
  report.biased_shortcuts = ray::shortcuts(scene);
  return report;
}

void LightcutsKernel::shade(std::span<const SurfacePoint> points, const SceneFrame& scene,
                            TileScheduler& scheduler, std::span<Rgb> out) const {
  ray::RayKernel(config_.ray).shade(points, scene, scheduler, out);
}

}  // namespace macula::kernels::lightcuts
