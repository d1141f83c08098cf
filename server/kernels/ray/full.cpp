#include "server/kernels/ray/full.h"

#include <algorithm>

#include "server/kernels/ray/tile.h"

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

std::vector<scheduling::TilePlace> places_of(std::span<const View> views,
                                             std::span<const Job> jobs) {
  std::vector<scheduling::TilePlace> places;
  for (const Job& job : jobs) {
    const PixelGrid& grid = views[job.view].grid;
    places.push_back(scheduling::place_of(job.tile, grid.width(), grid.height(), job.view));
  }
  return places;
}

FrameReport total(const std::vector<FrameReport>& parts) {
  FrameReport sum;
  for (const FrameReport& part : parts) sum += part;
  return sum;
}

}  // namespace

FrameReport render_full(const FrameRequest& request, const SceneFrame& scene, const Config& config,
                        TileScheduler& scheduler, FrameBuffers& out, Audience audience,
                        std::span<const image::Plane<std::uint16_t>> cut_nodes) {
  std::vector<ViewContext> contexts;
  contexts.reserve(request.views.size());
  for (const View& view : request.views) {
    contexts.emplace_back(view, scene, config, request, out.wanted);
  }
  for (std::size_t v = 0; v < cut_nodes.size(); ++v) contexts[v].cut_nodes = &cut_nodes[v];
  const std::vector<Job> jobs = list_jobs(request.views);
  std::vector<FrameReport> parts(jobs.size());
  const auto outcome = scheduling::run_shared(
      scheduler, jobs.size(), audience, [&] { return places_of(request.views, jobs); },
      [&](std::size_t index) {
        const Job& job = jobs[index];
        parts[index] = render_tile(contexts[job.view], job.tile, out.views[job.view]);
      },
      [&](std::size_t index, Parcel& parcel) {
        carry(parts[index], parcel);
        carry(out.views[jobs[index].view], jobs[index].tile, parcel);
      });
  FrameReport report = total(parts);
  report.stopped = outcome == scheduling::Outcome::Stopped;
  return report;
}

}  // namespace macula::kernels::ray
