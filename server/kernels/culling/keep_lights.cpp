#include "server/kernels/culling/keep_lights.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/kernels/culling/contribution.h"
#include "server/kernels/culling/importance.h"
#include "server/kernels/culling/shading_points.h"
#include "server/kernels/culling/stage_clock.h"
#include "server/kernels/culling/stochastic_culling.h"
#include "server/kernels/ray/guide.h"
#include "server/lights/morton.h"
#include "server/reconstruction/backward_warp.h"
#include "shared/image/tone.h"

namespace macula::kernels::culling {
namespace {

using lights::VirtualPointLight;
using sampling::SampleKey;

constexpr std::uint64_t kPointsKey = 0xC0117'0001ULL, kCullKey = 0xC0117'0002ULL;

vpl::Config lamps_of(const Config& config, std::uint64_t seed) {
  return {config.map_side, config.map_side, config.ray.materials, seed};
}

std::vector<VirtualPointLight> in_morton_order(std::vector<VirtualPointLight> lights) {
  std::vector<Vec3> positions(lights.size());
  std::ranges::transform(lights, positions.begin(),
                         [](const VirtualPointLight& light) { return Vec3(light.position); });
  lights::MortonOrder order;
  std::vector<VirtualPointLight> sorted;
  sorted.reserve(lights.size());
  for (const std::uint32_t i : order.sort(positions)) sorted.push_back(lights[i]);
  return sorted;
}

double half_extent(std::span<const VirtualPointLight> lights) {
  scene::Bounds box;
  for (const VirtualPointLight& light : lights) box.include(light.position);
  return 0.5 * glm::length(box.size());
}

/// Brightness of indirect light remembered where each cell's surface lay in the last frame;
/// infinite where it is not known.
Plane<float> remembered_brightness(const View& view, const ViewBuffers& surfaces,
                                   const ViewMemory& then) {
  const reconstruction::BackwardWarp warp(view.world_from_view, then.world_from_view, then.grid);
  const float gain = std::exp2(view.tone.exposure_ev);
  Plane<float> brightness(surfaces.depth_m.width(), surfaces.depth_m.height(),
                          std::numeric_limits<float>::infinity());
  for (int y = 0; y < brightness.height(); ++y) {
    for (int x = 0; x < brightness.width(); ++x) {
      const auto place = warp.then(view.grid.tangent(x, y), surfaces.depth_m(x, y));
      if (!place) continue;
      const int tx = static_cast<int>(place->cell.x), ty = static_cast<int>(place->cell.y);
      if (!then.light.contains(tx, ty)) continue;
      brightness(x, y) = std::min(gain * image::luminance(then.light(tx, ty)), 1.0F);
    }
  }
  return brightness;
}

Plane<float> importance_of(const View& view, const ViewBuffers& surfaces,
                           const Plane<float>& acuity, const ViewMemory* then,
                           const ImportanceConfig& config) {
  const Plane<float> unknown;
  const Plane<float> known =
      then != nullptr ? remembered_brightness(view, surfaces, *then) : Plane<float>{};
  return make_importance({acuity, surfaces.depth_m, surfaces.normal, surfaces.albedo,
                          then != nullptr ? known : unknown},
                         config);
}

ShadingPoint shading_point(const View& view, const ViewBuffers& surfaces,
                           const image::Pixel& cell) {
  const DVec3 direction =
      view.world_from_view.transform_direction(DVec3(view.grid.ray(cell.x, cell.y)));
  const double depth = surfaces.depth_m(cell.x, cell.y);
  ShadingPoint point;
  point.position = Vec3(view.world_from_view.position + depth * direction);
  const Vec3 normal = surfaces.normal(cell.x, cell.y);
  point.normal = glm::dot(normal, Vec3(direction)) > 0.0F ? -normal : normal;
  point.distance_m = static_cast<float>(depth * glm::length(direction));
  point.albedo = image::luminance(surfaces.albedo(cell.x, cell.y));
  return point;
}

/// Shading points over all views, each view's share by its importance.
class PointDrawing {
 public:
  PointDrawing(const FrameRequest& request, const Config& config)
      : config_(config), key_(request.seed, request.frame, kPointsKey) {}

  void add(const View& view, const ViewBuffers& surfaces, const Plane<float>& importance,
           int count) {
    const auto cells = config_.points == PointDraw::Systematic
                           ? draw_systematically(importance, count, sampling::sample(key_, 0))
                           : draw_by_chains(importance, count, config_.chain_length, key_);
    for (const image::Pixel& cell : cells) points_.push_back(shading_point(view, surfaces, cell));
  }
  const std::vector<ShadingPoint>& points() const { return points_; }

 private:
  const Config& config_;
  SampleKey key_;
  std::vector<ShadingPoint> points_;
};

std::vector<ShadingPoint> draw_points(const FrameRequest& request, const SceneFrame& scene,
                                      const Config& config, const CullingHistory& memory,
                                      TileScheduler& scheduler, FrameReport& report) {
  const std::vector<View> views = ray::thinned(request.views, config.guide_step);
  const FrameRequest guide{views, request.foveation, request.frame, request.seed};
  const FrameBuffers surfaces =
      ray::trace_surfaces(guide, scene, config.ray, kNormal | kAlbedo, scheduler, report);
  if (report.stopped) return {};
  const auto acuity = ray::acuity_of(guide, config.importance.acuity);
  PointDrawing drawing(request, config);
  const bool remembers = memory.views.size() == views.size();
  const int each = std::max(config.shading_points / static_cast<int>(views.size()), 1);
  for (std::size_t v = 0; v < views.size(); ++v) {
    const ViewMemory* then = remembers ? &memory.views[v] : nullptr;
    drawing.add(views[v], surfaces.views[v],
                importance_of(views[v], surfaces.views[v], acuity[v], then, config.importance),
                each);
  }
  return drawing.points();
}

/// Visibility as the last frames found it, the newest counting a quarter.
void remember_visibility(std::vector<float>& known, std::vector<float>& visible) {
  constexpr float kNewest = 0.25F;
  if (known.size() == visible.size()) {
    for (std::size_t i = 0; i < known.size(); ++i)
      visible[i] = std::lerp(known[i], visible[i], kNewest);
  }
  known = visible;
}

/// Every virtual light, as it was made.
KeptLights made_lights(const SceneFrame& scene, const Config& config, std::uint64_t seed,
                       TileScheduler& scheduler) {
  StageClock clock;
  vpl::VirtualLights made = vpl::make_virtual_lights(scene, lamps_of(config, seed), scheduler);
  KeptLights all;
  all.made = made.lights.size();
  all.report.stopped = made.stopped;
  all.report.shadow_rays = made.rays;
  all.lights = std::move(made.lights);
  if (config.ray.mode == Mode::Fast)
    all.least_m = static_cast<double>(config.nearest) * half_extent(all.lights);
  all.stages.lights_ms = clock.lap_ms();
  return all;
}

/// What each light brings to the frame's shading points, hidden as rays found.
std::vector<float> what_each_brings(const FrameRequest& request, const SceneFrame& scene,
                                    const Config& config, CullingHistory& memory,
                                    TileScheduler& scheduler, KeptLights& all) {
  const bool exact = config.ray.mode == Mode::Exact;
  const CullingHistory nothing;
  StageClock clock;
  const auto points =
      draw_points(request, scene, config, exact ? nothing : memory, scheduler, all.report);
  all.stages.importance_ms = clock.lap_ms();
  Contributions found =
      contributions(scene, all.lights, points, config, all.least_m, request.frame, scheduler);
  all.stages.contribution_ms = clock.lap_ms();
  all.report.shadow_rays += found.rays;
  all.report.stopped = all.report.stopped || found.stopped;
  if (!exact) remember_visibility(memory.visible, found.visible);
  for (std::size_t i = 0; i < found.visible.size(); ++i) found.unhidden[i] *= found.visible[i];
  return std::move(found.unhidden);
}

}  // namespace

KeptLights all_lights(const SceneFrame& scene, const Config& config, std::uint64_t seed,
                      TileScheduler& scheduler) {
  KeptLights all = made_lights(scene, config, seed, scheduler);
  all.lights = in_morton_order(std::move(all.lights));
  return all;
}

KeptLights keep_lights(const FrameRequest& request, const SceneFrame& scene, const Config& config,
                       CullingHistory& memory, TileScheduler& scheduler) {
  const SampleKey key(request.seed, request.frame, kCullKey);
  const std::uint64_t seed = config.ray.mode == Mode::Exact ? key.value : 0;
  KeptLights kept = made_lights(scene, config, seed, scheduler);
  if (kept.report.stopped) return kept;
  if (kept.made > static_cast<std::size_t>(config.kept)) {
    const auto brought = config.kept_by == KeptBy::Flux
                             ? std::vector<float>(kept.made)
                             : what_each_brings(request, scene, config, memory, scheduler, kept);
    StageClock clock;
    kept.lights = cull(kept.lights, brought, config, sampling::sample(key, 1));
    kept.stages.culling_ms = clock.lap_ms();
  }
  kept.lights = in_morton_order(std::move(kept.lights));
  return kept;
}

}  // namespace macula::kernels::culling
