#include "server/kernels/lightcuts/deferred.h"

#include <limits>

#include "server/kernels/lightcuts/cut_light.h"
#include "server/kernels/lightcuts/other_light.h"
#include "server/kernels/planes.h"
#include "shared/math/hash.h"

namespace macula::kernels::lightcuts {
namespace {

/// The map must not depend on draws that it decides to keep: they have a seed of their own.
constexpr std::uint64_t kKeptSeed = 0x10'0A11'0002ULL;

std::vector<LowPicture> draw_low(const FrameRequest& request, const SceneFrame& scene,
                                 const Config& config, TileScheduler& scheduler,
                                 FrameReport& report) {
  const std::vector<View> views = thinned(request.views, config.low_resolution);
  const FrameRequest low{views, request.foveation, request.frame,
                         math::hash_combine(request.seed, kKeptSeed)};
  FrameBuffers unused;
  prepare_buffers(views, unused);
  std::vector<ViewSurfaces> surfaces;
  report += trace_surfaces(low, scene, config.ray, scheduler, surfaces, unused);
  std::vector<LowPicture> pictures(views.size());
  for (std::size_t v = 0; v < views.size() && !report.stopped; ++v) {
    pictures[v].factor = config.low_resolution;
    report += draw_low_picture(scene, surfaces[v], config.kept_nodes, scheduler, pictures[v]);
  }
  return pictures;
}

/// Radiance that is no number becomes black, and is counted.
void add(const Rgb& light, Rgb& radiance, FrameReport& report) {
  radiance += light;
  if (math::is_finite(radiance)) return;
  radiance = Rgb{0.0F};
  ++report.non_finite_samples;
}

FrameReport light_tile(const SceneFrame& scene, const ray::Config& config, const SurfaceTile& tile,
                       const CutPlan& plan, ViewBuffers& out) {
  FrameReport report;
  CutWork work;
  std::vector<Rgb> light(tile.points.count, Rgb{0.0F});
  add_lights_apart(scene, tile.points, work.lighting, light);
  add_cut_light(scene, tile, plan, work, light);
  add_surroundings(scene, config, tile.points, work.lighting, light);
  for (std::size_t i = 0; i < light.size(); ++i) {
    const image::Pixel at = tile.pixel(i);
    add(light[i], out.radiance(at.x, at.y), report);
  }
  report.shadow_rays = work.lighting.shadow_rays;
  report.trace_ms = work.lighting.trace_ms;
  report.walked_nodes = work.walked, report.taken_nodes = work.taken;
  return report;
}

void fill_sample_planes(unsigned wanted, ViewBuffers& out) {
  if (wanted & kSamples) {
    for (float& each : out.samples.pixels()) each = 1.0F;
  }
  if (wanted & kVariance) {
    for (float& each : out.variance.pixels()) each = std::numeric_limits<float>::infinity();
  }
}

}  // namespace

FrameReport render_deferred(const FrameRequest& request, const SceneFrame& scene,
                            const Config& config, TileScheduler& scheduler, FrameBuffers& out) {
  const unsigned wanted = out.wanted;
  out.wanted |= kNormal | kAlbedo;  // the map's features
  prepare_buffers(request.views, out);
  std::vector<ViewSurfaces> surfaces;
  FrameReport report = trace_surfaces(request, scene, config.ray, scheduler, surfaces, out);
  LightPlan plan;
  if (!report.stopped) plan = plan_lights(request, scene, config, out, scheduler);
  report += plan.report;
  out.wanted = wanted;
  std::vector<LowPicture> low;
  const bool keeps = config.source == LightSource::LowResolution;
  if (keeps && !report.stopped) low = draw_low(request, scene, config, scheduler, report);
  for (std::size_t v = 0; v < surfaces.size() && !report.stopped; ++v) {
    const CutPlan cuts{plan.cut_nodes[v], config.most_nodes, &plan.maps[v].map,
                       keeps ? &low[v] : nullptr};
    std::vector<FrameReport> parts(surfaces[v].tiles.size());
    const auto outcome = scheduler.run(parts.size(), [&](std::size_t k) {
      parts[k] = light_tile(scene, config.ray, surfaces[v].tiles[k], cuts, out.views[v]);
    });
    for (const FrameReport& part : parts) report += part;
    report.stopped |= outcome == scheduling::Outcome::Stopped;
    fill_sample_planes(wanted, out.views[v]);
  }
  return report;
}

}  // namespace macula::kernels::lightcuts
