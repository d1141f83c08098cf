#include "server/kernels/lightcuts/lightcuts_kernel.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "server/kernels/planes.h"
#include "server/kernels/ray/full.h"
#include "server/kernels/ray/ray_kernel.h"
#include "shared/math/hash.h"

namespace macula::kernels::lightcuts {
namespace {

/// Told apart from the frame's own seed: sizes of cuts must not depend on what the cuts draw.
constexpr std::uint64_t kLowResolutionSeed = 0x10'0A11'0001ULL;

ray::Config surfaces_only(const Config& config) {
  ray::Config guide = config.ray;
  guide.lights = ray::LightChoice::None;
  guide.samples_per_cell = 1;
  guide.placement = ray::Placement::Fixed;
  return guide;
}

ray::Config low_resolution(const Config& config) {
  ray::Config low = config.ray;
  low.samples_per_cell = 1;
  low.area_light_samples = config.low_nodes;
  return low;
}

/// Every n-th edge and the last.
std::vector<float> thinned(const std::vector<float>& edges, int n) {
  std::vector<float> kept;
  for (std::size_t i = 0; i + 1 < edges.size(); i += static_cast<std::size_t>(n)) {
    kept.push_back(edges[i]);
  }
  kept.push_back(edges.back());
  return kept;
}

std::vector<View> thinned(std::span<const View> views, int n) {
  std::vector<View> low(views.begin(), views.end());
  for (View& view : low) {
    view.grid = {thinned(view.grid.x_edges, n), thinned(view.grid.y_edges, n)};
  }
  return low;
}

/// As it is shown: contrast is told against a least luminance of the display's.
Plane<float> shown_luminance(const Plane<Rgb>& radiance, const image::Tone& tone) {
  Plane<float> luminance(radiance.width(), radiance.height());
  const float gain = std::exp2(tone.exposure_ev);
  std::ranges::transform(radiance.pixels(), luminance.pixels().begin(),
                         [gain](const Rgb& c) { return gain * image::luminance(c); });
  return luminance;
}

/// The paper's acuity; a cell of a foveal grid, which stands for many pixels, deserves that of all.
std::vector<Plane<float>> acuity_of(const FrameRequest& request) {
  foveation::RateModel model;
  model.curve = foveation::RateCurve::Lightcuts;
  std::vector<FoveationMap::ViewInput> inputs;
  for (std::size_t v = 0; v < request.views.size(); ++v) {
    inputs.push_back(request.foveation.view(v));
  }
  const FoveationMap map(std::move(inputs), model);
  std::vector<Plane<float>> acuity;
  for (std::size_t v = 0; v < request.views.size(); ++v) {
    const PixelGrid& grid = request.views[v].grid;
    acuity.emplace_back(grid.width(), grid.height());
    for (int y = 0; y < grid.height(); ++y) map.samples_wanted_row(v, y, acuity[v].row(y));
  }
  return acuity;
}

FrameBuffers traced(const FrameRequest& request, const SceneFrame& scene, const ray::Config& config,
                    unsigned wanted, TileScheduler& scheduler, FrameReport& report) {
  FrameBuffers buffers;
  buffers.wanted = wanted;
  prepare_buffers(request.views, buffers);
  report += ray::render_full(request, scene, config, scheduler, buffers);
  return buffers;
}

std::vector<Plane<float>> low_luminance(const FrameRequest& request, const SceneFrame& scene,
                                        const Config& config, TileScheduler& scheduler,
                                        FrameReport& report) {
  std::vector<Plane<float>> luminance(request.views.size());
  if (config.low_nodes <= 0) return luminance;
  const std::vector<View> views = thinned(request.views, config.low_resolution);
  const FrameRequest low{views, request.foveation, request.frame,
                         math::hash_combine(request.seed, kLowResolutionSeed)};
  const FrameBuffers made = traced(low, scene, low_resolution(config), 0, scheduler, report);
  for (std::size_t v = 0; v < views.size(); ++v) {
    luminance[v] = shown_luminance(made.views[v].radiance, views[v].tone);
  }
  return luminance;
}

}  // namespace

LightPlan plan_lights(const FrameRequest& request, const SceneFrame& scene, const Config& config,
                      TileScheduler& scheduler) {
  LightPlan plan;
  const FrameBuffers surfaces =
      traced(request, scene, surfaces_only(config), kNormal | kAlbedo, scheduler, plan.report);
  const auto luminance = low_luminance(request, scene, config, scheduler, plan.report);
  if (plan.report.stopped) return plan;
  const auto begin = std::chrono::steady_clock::now();
  const auto acuity = acuity_of(request);
  const Plane<float> at_rest;
  for (std::size_t v = 0; v < request.views.size(); ++v) {
    const ViewBuffers& view = surfaces.views[v];
    plan.maps.push_back(make_perception_map(
        {acuity[v], view.normal, view.albedo, at_rest, luminance[v]}, config.perception));
    plan.cut_nodes.push_back(
        node_counts(plan.maps[v].map, config.most_nodes, config.mean_nodes).nodes);
  }
  plan.report.mask_ms = units::to_ms(std::chrono::steady_clock::now() - begin);
  return plan;
}

FrameReport LightcutsKernel::render(const FrameRequest& request, const SceneFrame& scene,
                                    History& history, TileScheduler& scheduler,
                                    FrameBuffers& out) const {
  const bool perceived = config_.sizes == CutSizes::Perceived && config_.ray.mode == Mode::Fast;
  if (!perceived)
    return ray::RayKernel(config_.ray).render(request, scene, history, scheduler, out);
  LightPlan plan = plan_lights(request, scene, config_, scheduler);
  prepare_buffers(request.views, out);
  if (plan.report.stopped) return plan.report;
  ray::Config config = config_.ray;
  config.area_light_samples = config_.most_nodes;
  FrameReport report = ray::render_full(request, scene, config, scheduler, out, plan.cut_nodes);
  report += plan.report;
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
