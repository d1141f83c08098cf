#include "server/kernels/ray/ray_kernel.h"

#include <algorithm>
#include <vector>

#include "server/kernels/planes.h"
#include "server/kernels/ray/foveated.h"
#include "server/kernels/ray/shading_point.h"
#include "server/kernels/ray/tile.h"
#include "shared/base/check.h"

namespace macula::kernels::ray {
namespace {

struct Job {
  std::size_t view;
  image::Rect tile;
};

/// The tiles of every view in one list: both eyes share the threads to the end.
std::vector<Job> list_jobs(std::span<const View> views) {
  std::vector<Job> jobs;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const int width = views[v].grid.width(), height = views[v].grid.height();
    for (int y = 0; y < height; y += kTileSide) {
      for (int x = 0; x < width; x += kTileSide) {
        jobs.push_back(
            {v, {x, y, std::min(kTileSide, width - x), std::min(kTileSide, height - y)}});
      }
    }
  }
  return jobs;
}

FrameReport total(const std::vector<FrameReport>& parts) {
  FrameReport sum;
  for (const FrameReport& part : parts) sum += part;
  return sum;
}

/// Every cell of every view, every frame.
FrameReport render_full(const FrameRequest& request, const SceneFrame& scene, const Config& config,
                        TileScheduler& scheduler, FrameBuffers& out) {
  std::vector<ViewContext> contexts;
  contexts.reserve(request.views.size());
  for (const View& view : request.views) {
    contexts.emplace_back(view, scene, config, request, out.wanted);
  }
  const std::vector<Job> jobs = list_jobs(request.views);
  std::vector<FrameReport> parts(jobs.size());
  const auto outcome = scheduler.run(jobs.size(), [&](std::size_t index) {
    const Job& job = jobs[index];
    parts[index] = render_tile(contexts[job.view], job.tile, out.views[job.view]);
  });
  FrameReport report = total(parts);
  report.stopped = outcome == scheduling::Outcome::Stopped;
  return report;
}

}  // namespace

FrameReport RayKernel::render(const FrameRequest& request, const SceneFrame& scene,
                              History& history, TileScheduler& scheduler, FrameBuffers& out) const {
  prepare_buffers(request.views, out);
  const bool foveated = config_.mode == Mode::Fast && config_.foveated.method == Method::Foveated;
  FrameReport report = foveated ? render_foveated(request, scene, config_, history, scheduler, out)
                                : render_full(request, scene, config_, scheduler, out);
  if (!report.stopped) {
    report.stopped = fill_rate(request, scheduler, out) == scheduling::Outcome::Stopped;
  }
  if (config_.mode == Mode::Fast) {
    report.biased_shortcuts.emplace_back(
        "textures are averaged over the cell before shading (trilinear, isotropic)");
    if (scene.triangles().blends()) {
      report.biased_shortcuts.emplace_back(
          "a blended surface is met by a fixed share of a cell's samples, and those behind it too");
    }
  }
  return report;
}

void RayKernel::shade(std::span<const SurfacePoint> points, const SceneFrame& scene,
                      TileScheduler& scheduler, std::span<Rgb> out) const {
  MACULA_CHECK(points.size() == out.size());
  constexpr std::size_t kBatch = visibility::kStreamCapacity;
  const Lighting lighting(scene, config_);
  scheduler.run((points.size() + kBatch - 1) / kBatch, [&](std::size_t batch) {
    const std::size_t first = batch * kBatch;
    const std::size_t count = std::min(kBatch, points.size() - first);
    shade_batch(points.subspan(first, count), scene, config_, lighting, out.subspan(first, count));
  });
}

}  // namespace macula::kernels::ray
