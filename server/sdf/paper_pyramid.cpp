#include "server/sdf/paper_pyramid.h"

#include <algorithm>

#include "server/sdf/ray_block.h"
#include "server/sdf/surfaces.h"
#include "shared/base/check.h"

namespace macula::sdf {
namespace {

/// Every `step`-th edge, and the last one.
std::vector<float> thinned(const std::vector<float>& edges, std::size_t step) {
  std::vector<float> kept;
  for (std::size_t i = 0; i + 1 < edges.size(); i += step) kept.push_back(edges[i]);
  kept.push_back(edges.back());
  return kept;
}

}  // namespace

PaperPyramid::PaperPyramid(const Program& program, const DMat3& scene_from_view,
                           const PixelGrid& grid, const PaperOptions& options)
    : program_(&program), scene_from_view_(scene_from_view), options_(options) {
  for (std::size_t level = 0; level < kLevels; ++level) {
    const std::size_t step = std::size_t{4} >> level;
    grids_[level] = {thinned(grid.x_edges, step), thinned(grid.y_edges, step)};
    distances_[level].resize(grids_[level].width(), grids_[level].height(), program.far_m);
  }
}

Result<PaperPyramid> PaperPyramid::create(const Program& program, const DMat3& scene_from_view,
                                          const PixelGrid& grid, const PaperOptions& options) {
  if (options.filter != 1 && options.filter != 3 && options.filter != 5)
    return base::bad_input("no such minimum filter", "filter", "1, 3 or 5 cells a side");
  TraceOptions common;
  common.samples = options.samples, common.max_steps = options.max_steps;
  common.hit_pixels = options.hit_pixels, common.hit_m = options.hit_m;
  const auto checked = Tracer::create(program, scene_from_view, grid, common);
  if (!checked) return forward(checked);
  return PaperPyramid(program, scene_from_view, grid, options);
}

float PaperPyramid::start_of(int level, int x, int y) const {
  if (level == 0) return 0.0F;
  const image::Plane<float>& coarse = distances_[static_cast<std::size_t>(level - 1)];
  const int reach = options_.filter / 2;
  float least = program_->far_m;
  for (int v = y / 2 - reach; v <= y / 2 + reach; ++v) {
    for (int u = x / 2 - reach; u <= x / 2 + reach; ++u) {
      if (coarse.contains(u, v)) least = std::min(least, coarse(u, v));
    }
  }
  return least;
}

TraceCounts PaperPyramid::trace(int level, const image::Rect& tile, TraceWorkspace& workspace,
                                const Tracer::Done& done) {
  MACULA_CHECK(level >= 0 && level < kLevels);
  TraceCounts counts;
  const int side = options_.samples > 2 ? kBlockSide / 2 : kBlockSide;
  for (int y = tile.y; y < tile.y + tile.height; y += side) {
    for (int x = tile.x; x < tile.x + tile.width; x += side) {
      const image::Rect cells{x, y, std::min(side, tile.x + tile.width - x),
                              std::min(side, tile.y + tile.height - y)};
      counts += trace_block(level, cells, workspace.scratch());
      if (level == kLevels - 1) done(workspace.scratch().block);
    }
  }
  return counts;
}

TraceCounts PaperPyramid::trace_block(int level, const image::Rect& cells, TraceScratch& s) {
  const bool last = level == kLevels - 1;
  const int samples = last ? options_.samples : 1;
  const MarchLimits limits{
      .far_m = program_->far_m, .hit_m = options_.hit_m, .max_steps = options_.max_steps};
  s.block_slabs.reset_whole(*program_);
  s.wanted.assign(static_cast<std::size_t>(cells.width * cells.height), 1);
  s.block.cells = cells;
  const std::size_t rays =
      aim_rays({grid(level), scene_from_view_, cells, samples, options_.hit_pixels}, s);
  const auto each = static_cast<std::size_t>(samples);
  for (std::size_t i = 0; i < rays; i += each) {
    const float start = start_of(level, s.block.hits[i].x, s.block.hits[i].y);
    if (start < limits.far_m) send_rays(i, each, start, s);
    if (!(start < limits.far_m)) drop_rays(i, each, s);
  }
  TraceCounts counts{.rays = rays};
  const MarchWork work = march(Stepping::Plain, limits, s);
  take_results(s, counts);
  image::Plane<float>& out = distances_[static_cast<std::size_t>(level)];
  for (const Hit& hit : s.block.hits) out(hit.x, hit.y) = std::min(hit.t, limits.far_m);
  const MarchWork surfaces = last ? find_surfaces(limits, s, s.block.hits) : MarchWork{};
  counts.ray_evaluations = work.evaluations;
  counts.surface_evaluations = surfaces.evaluations;
  counts.operations = work.operations + surfaces.operations;
  return counts;
}

}  // namespace macula::sdf
