#include "server/kernels/culling/keep_lights.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/kernels/culling/camera_lights.h"
#include "server/kernels/culling/contribution.h"
#include "server/kernels/culling/light_cuts.h"
#include "server/kernels/culling/look.h"
#include "server/kernels/culling/stage_clock.h"
#include "server/kernels/culling/stochastic_culling.h"
#include "server/lights/morton.h"
#include "server/sampling/sample.h"

namespace macula::kernels::culling {
namespace {

using lights::VirtualPointLight;
using sampling::SampleKey;

constexpr std::uint64_t kCullKey = 0xC0117'0002ULL, kWanderKey = 0xC0117'0005ULL;

/// Many lamps share what `most_made` allows.
vpl::Config lamps_of(const SceneFrame& scene, const Config& config, std::uint64_t seed) {
  const auto lamps = std::max<std::size_t>(scene.lights().punctual().size(), 1);
  const double share =
      std::sqrt(static_cast<double>(config.most_made) / static_cast<double>(lamps));
  const int side = std::clamp(static_cast<int>(share), 1, config.map_side);
  return {side, config.map_side, config.ray.materials, seed};
}

/// Elsewhere in every frame, but near the same places: what each light brings is remembered.
vpl::Config wandering(const FrameRequest& request, const SceneFrame& scene, const Config& config) {
  vpl::Config rays = lamps_of(scene, config, 0);
  const auto lamps =
      static_cast<double>(std::max<std::size_t>(scene.lights().punctual().size(), 1));
  if (lamps * rays.side * rays.side <= config.kept) return rays;
  const SampleKey key(request.seed, request.frame, kWanderKey);
  const float step = config.wander / static_cast<float>(rays.side);
  rays.shift = step * Vec2{sampling::sample(key, 0), sampling::sample(key, 1)};
  return rays;
}

std::vector<VirtualPointLight> in_morton_order(std::vector<VirtualPointLight> lights) {
  std::vector<Vec4> positions;
  scene::Bounds box;
  for (const VirtualPointLight& light : lights) {
    positions.emplace_back(Vec3(light.position), 0.0F);
    box.include(light.position);
  }
  base::BigVector<std::uint32_t> order;
  const lights::MortonCube cube = lights.empty()
                                      ? lights::MortonCube{}
                                      : lights::cube_about(Vec3(box.minimum), Vec3(box.maximum));
  lights::MortonOrder().sort(positions, cube, order);
  std::vector<VirtualPointLight> sorted;
  sorted.reserve(lights.size());
  for (const std::uint32_t i : order) sorted.push_back(lights[i]);
  return sorted;
}

double half_extent(std::span<const VirtualPointLight> lights) {
  scene::Bounds box;
  for (const VirtualPointLight& light : lights) box.include(light.position);
  return 0.5 * glm::length(box.size());
}

std::size_t cells_of(const FrameRequest& request) {
  std::size_t cells = 0;
  for (const View& view : request.views)
    cells +=
        static_cast<std::size_t>(view.grid.width()) * static_cast<std::size_t>(view.grid.height());
  return cells;
}

/// Few shading points a frame, many over time. Pictures of quite another size had points elsewhere.
void remember_brought(std::size_t cells, std::vector<float>& brought, CullingHistory& memory) {
  constexpr int kMostFrames = 4;
  const bool alike = cells <= 2 * memory.brought_cells && memory.brought_cells <= 2 * cells;
  const bool known = alike && memory.brought.size() == brought.size();
  memory.brought_cells = cells;
  memory.brought_frames = known ? std::min(memory.brought_frames + 1, kMostFrames) : 1;
  if (known) {
    const float newest = 1.0F / static_cast<float>(memory.brought_frames);
    for (std::size_t i = 0; i < brought.size(); ++i)
      brought[i] = std::lerp(memory.brought[i], brought[i], newest);
  }
  memory.brought = brought;
}

bool all_diffuse(const SceneFrame& scene, const Config& config) {
  return config.ray.materials == shading::MaterialModel::Lambert ||
         scene.plan().use(scene::Step::SpecularLobe) != scene::StepUse::Used;
}

void set_least_distance(const SceneFrame& scene, const Config& config, KeptLights& all) {
  const bool exact = config.ray.mode == Mode::Exact;
  if (!exact || all_diffuse(scene, config))
    all.least_m = static_cast<double>(config.nearest) * half_extent(all.lights);
  if (!exact) return;
  // What is brought back by a short ray has one length for all.
  for (VirtualPointLight& light : all.lights)
    light.footprint_m = std::numeric_limits<float>::infinity();
}

/// Every virtual light, as it was made.
KeptLights made_lights(const SceneFrame& scene, const Config& config, const vpl::Config& rays,
                       TileScheduler& scheduler) {
  StageClock clock;
  vpl::VirtualLights made = vpl::make_virtual_lights(scene, rays, scheduler);
  KeptLights all;
  all.made = made.lights.size();
  all.report.stopped = made.stopped;
  all.report.shadow_rays = made.rays;
  all.lights = std::move(made.lights);
  set_least_distance(scene, config, all);
  all.stages.lights_ms = clock.lap_ms();
  return all;
}

/// What each light brings to the last frames' shading points, hidden as rays or maps found.
std::vector<float> what_each_brings(const FrameRequest& request, const SceneFrame& scene,
                                    const Config& config, CullingHistory& memory,
                                    TileScheduler& scheduler, KeptLights& all) {
  const bool exact = config.ray.mode == Mode::Exact;
  const CullingHistory nothing;
  StageClock clock;
  const Look seen = look(request, scene, config, exact ? nothing : memory, scheduler);
  all.report += seen.report;
  const auto points = draw_points(seen, config, config.shading_points, request.seed, request.frame);
  all.stages.importance_ms = clock.lap_ms();
  Contributions found =
      contributions(scene, all.lights, points, config, all.least_m, request.frame, scheduler);
  all.stages.contribution_ms = clock.lap_ms();
  all.report.shadow_rays += found.rays;
  all.report.stopped = all.report.stopped || found.stopped;
  std::vector<float> brought = std::move(found.unhidden);
  for (std::size_t i = 0; i < brought.size(); ++i) brought[i] *= found.visible[i];
  if (!exact) remember_brought(cells_of(request), brought, memory);
  if (config.mean == PointMean::OfSquares)
    for (float& value : brought) value = std::sqrt(value);
  return brought;
}

void keep_some(const FrameRequest& request, const SceneFrame& scene, const Config& config,
               CullingHistory& memory, TileScheduler& scheduler, KeptLights& kept) {
  const SampleKey key(request.seed, request.frame, kCullKey);
  const auto brought = config.kept_by == KeptBy::Flux
                           ? std::vector<float>(kept.made)
                           : what_each_brings(request, scene, config, memory, scheduler, kept);
  StageClock clock;
  kept.lights = cull(kept.lights, brought, config, sampling::sample(key, 1));
  kept.stages.culling_ms = clock.lap_ms();
}

/// As many nodes a cell, on average, as culling would have it ask lights.
void plan_cuts(const FrameRequest& request, const SceneFrame& scene, const Config& config,
               const CullingHistory& memory, TileScheduler& scheduler, KeptLights& kept) {
  constexpr int kMostOverMean = 8;
  StageClock clock;
  const CullingHistory nothing;
  const bool exact = config.ray.mode == Mode::Exact;
  const Look seen = look(request, scene, config, exact ? nothing : memory, scheduler);
  kept.report += seen.report;
  const double mean = std::max(static_cast<double>(config.kept) / config.classes, 1.0);
  kept.most_nodes = static_cast<int>(std::ceil(kMostOverMean * mean));
  for (std::size_t v = 0; v < seen.importance.size(); ++v) {
    kept.cut_nodes.push_back(cut_sizes(request.views[v].grid, seen.importance[v], config.guide_step,
                                       mean, kept.most_nodes));
  }
  kept.stages.importance_ms = clock.lap_ms();
}

/// Looks where the eye does, whatever was seen there; the same lights for the same view.
KeptLights lights_from_camera(const FrameRequest& request, const SceneFrame& scene,
                              const Config& config, TileScheduler& scheduler) {
  constexpr int kPoints = 256;
  KeptLights kept;
  StageClock clock;
  const Look seen = look(request, scene, config, {}, scheduler);
  kept.report = seen.report;
  kept.stages.importance_ms = clock.lap_ms();
  if (kept.report.stopped) return kept;
  CameraLights made = camera_lights(scene, draw_points(seen, config, kPoints, request.seed, 0),
                                    config.kept, config, scheduler);
  kept.report.stopped = made.stopped;
  kept.report.shadow_rays += made.rays;
  kept.lights = std::move(made.lights);
  kept.made = static_cast<std::size_t>(config.kept);
  set_least_distance(scene, config, kept);
  kept.stages.lights_ms = clock.lap_ms();
  return kept;
}

}  // namespace

KeptLights all_lights(const SceneFrame& scene, const Config& config, std::uint64_t seed,
                      TileScheduler& scheduler) {
  KeptLights all = made_lights(scene, config, lamps_of(scene, config, seed), scheduler);
  all.lights = in_morton_order(std::move(all.lights));
  return all;
}

KeptLights keep_lights(const FrameRequest& request, const SceneFrame& scene, const Config& config,
                       CullingHistory& memory, TileScheduler& scheduler) {
  const bool exact = config.ray.mode == Mode::Exact;
  const std::uint64_t seed = SampleKey(request.seed, request.frame, kCullKey).value;
  KeptLights kept =
      config.source == LightSource::Camera
          ? lights_from_camera(request, scene, config, scheduler)
          : made_lights(scene, config,
                        exact ? lamps_of(scene, config, seed) : wandering(request, scene, config),
                        scheduler);
  if (kept.report.stopped) return kept;
  if (config.route == Route::Cuts) {
    plan_cuts(request, scene, config, memory, scheduler, kept);
  } else if (kept.lights.size() > static_cast<std::size_t>(config.kept)) {
    keep_some(request, scene, config, memory, scheduler, kept);
  }
  kept.lights = in_morton_order(std::move(kept.lights));
  return kept;
}

}  // namespace macula::kernels::culling
