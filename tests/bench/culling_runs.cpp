#include "tests/bench/culling_runs.h"

#include <algorithm>

#include "server/kernels/culling/keep_lights.h"
#include "server/kernels/planes.h"
#include "server/kernels/ray/guide.h"
#include "server/kernels/ray/tile.h"

namespace macula::bench {
namespace {

using base::forward;

constexpr std::uint64_t kSeed = 1;

}  // namespace

void Rendered::add(const Rendered& other) {
  lap.cpu_ms += other.lap.cpu_ms, lap.wall_ms += other.lap.wall_ms;
  stages += other.stages;
  shadow_rays += other.shadow_rays;
  made = other.made, kept = other.kept;
}

void Rendered::divide(int by) {
  lap.cpu_ms /= by, lap.wall_ms /= by;
  stages /= by;
  shadow_rays /= static_cast<std::uint64_t>(by);
}

void Rendered::count_cells_times(double factor) {
  const double cells_ms = stages.shading_ms + stages.post_ms;
  const double all_ms = stages.lights_ms + stages.importance_ms + stages.contribution_ms +
                        stages.culling_ms + cells_ms;
  const double longer = all_ms > 0.0 ? 1.0 + (factor - 1.0) * cells_ms / all_ms : 1.0;
  lap.cpu_ms *= longer, lap.wall_ms *= longer;
  stages.shading_ms *= factor, stages.post_ms *= factor;
  shadow_rays = static_cast<std::uint64_t>(factor * static_cast<double>(shadow_rays));
}

Result<Rendered> CullingSession::frame(int index) {
  const auto scene = setting_.frame(index);
  if (!scene) return forward(scene);
  const kernels::FrameRequest request{
      {&eye_.view, 1}, *eye_.map, static_cast<std::uint64_t>(index), seed_};
  Stopwatch watch;
  const auto report = kernel_.render(request, **scene, history_, scheduler_, buffers_);
  Rendered rendered;
  rendered.lap = watch.lap();
  rendered.radiance = buffers_.views.front().radiance;
  rendered.shadow_rays = report.shadow_rays;
  const auto& memory = kernels::record_of<kernels::culling::CullingHistory>(history_);
  rendered.stages = memory.stages, rendered.made = memory.made, rendered.kept = memory.kept;
  return rendered;
}

Result<Rendered> all_lights_at(std::span<const image::Pixel> pixels, int index,
                               const CullingSetting& setting,
                               const kernels::culling::Config& config,
                               scheduling::TileScheduler& scheduler) {
  const auto scene = setting.frame(index);
  if (!scene) return forward(scene);
  Stopwatch watch;
  const auto all = kernels::culling::all_lights(**scene, config, 0, scheduler);
  const lights::VirtualLightTable table(all.lights, 1, static_cast<float>(all.least_m));
  kernels::ray::Config lit = config.ray;
  lit.virtual_lights = {&table, 0};
  kernels::FrameBuffers out;
  kernels::prepare_buffers({&setting.view(), 1}, out);
  const kernels::FrameRequest request{
      {&setting.view(), 1}, setting.map(), static_cast<std::uint64_t>(index), kSeed + 1};
  const kernels::ray::ViewContext context(setting.view(), **scene, lit, request, 0);
  constexpr std::size_t kStep = 256;  // pixels of a tile
  const std::size_t tiles = (pixels.size() + kStep - 1) / kStep;
  std::vector<kernels::FrameReport> parts(tiles);
  scheduler.run(tiles, [&](std::size_t tile) {
    const std::size_t first = tile * kStep, count = std::min(kStep, pixels.size() - first);
    parts[tile] =
        kernels::ray::render_cells(context, pixels.subspan(first, count), out.views.front());
  });
  Rendered rendered;
  rendered.lap = watch.lap();
  rendered.radiance = std::move(out.views.front().radiance);
  for (const auto& part : parts) rendered.shadow_rays += part.shadow_rays;
  rendered.made = rendered.kept = all.made;
  rendered.stages.shading_ms = rendered.lap.wall_ms;
  return rendered;
}

Result<double> surfaces_cpu_ms(int index, const CullingSetting& setting,
                               const kernels::ray::Config& config,
                               scheduling::TileScheduler& scheduler) {
  const auto scene = setting.frame(index);
  if (!scene) return forward(scene);
  const kernels::FrameRequest request{{&setting.view(), 1}, setting.map(), 0, kSeed};
  kernels::FrameReport report;
  Stopwatch watch;
  kernels::ray::trace_surfaces(request, **scene, config, kernels::kNormal | kernels::kAlbedo,
                               scheduler, report);
  return watch.lap().cpu_ms;
}

}  // namespace macula::bench
