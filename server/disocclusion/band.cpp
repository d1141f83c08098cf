#include "server/disocclusion/band.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace macula::disocclusion {
namespace {

constexpr int kTileRows = 32;

float inverse_of(float depth_m) {
  return depth_m > 0.0F ? 1.0F / depth_m : 0.0F;  // also NaN
}

/// Half a cell's parallax as a difference of inverse depth.
float half_cell(const PixelGrid& grid, int x, int y, double radius_m) {
  const Vec2 cell = grid.footprint(x, y);
  return static_cast<float>(0.5 * static_cast<double>(std::min(cell.x, cell.y)) / radius_m);
}

/// What a near cell beside a silhouette uncovers at most.
struct Disc {
  int x, y;
  float reach;        ///< on the tangent plane
  float far_inverse;  ///< the far side's inverse depth, 1/m
};

/// Discs of the cells of one row that stand before a neighbour.
void add_discs(const image::Plane<float>& depth_m, const PixelGrid& grid, double radius_m, int y,
               std::vector<Disc>& discs) {
  const auto row = depth_m.row(y);
  const auto above = depth_m.row(std::max(y - 1, 0));
  const auto below = depth_m.row(std::min(y + 1, depth_m.height() - 1));
  const int last = depth_m.width() - 1;
  for (int x = 0; x <= last; ++x) {
    const float farthest =
        std::max({row[std::max(x - 1, 0)], row[std::min(x + 1, last)], above[x], below[x]});
    if (!(farthest > row[x])) continue;  // nothing is farther, or nothing is here
    const float near = inverse_of(row[x]), far = inverse_of(farthest);
    const float least = half_cell(grid, x, y, radius_m);
    if (near - far < least) continue;
    discs.push_back({x, y, static_cast<float>(radius_m) * (near - far), far});
  }
}

/// Indices of the cells whose centres lie within [low, high].
struct Range {
  int first, end;
};
Range centres_within(const std::vector<float>& edges, float low, float high) {
  const auto centre = [&](std::ptrdiff_t i) {
    const auto at = static_cast<std::size_t>(i);
    return 0.5F * (edges[at] + edges[at + 1]);
  };
  const auto cells = static_cast<std::ptrdiff_t>(edges.size()) - 1;
  auto first = std::lower_bound(edges.begin(), edges.end(), low) - edges.begin() - 1;
  first = std::clamp<std::ptrdiff_t>(first, 0, cells);
  while (first < cells && centre(first) < low) ++first;
  auto end = first;
  while (end < cells && centre(end) <= high) ++end;
  return {static_cast<int>(first), static_cast<int>(end)};
}

/// Marks what a disc uncovers in rows [first, end).
void mark(const Disc& disc, const image::Plane<float>& depth_m, const PixelGrid& grid,
          double radius_m, int first, int end, Band& out) {
  const Vec2 centre = grid.tangent(disc.x, disc.y), cell = grid.footprint(disc.x, disc.y);
  const float reach = disc.reach + std::max(cell.x, cell.y);  // the silhouette is known to a cell
  if (centre.y + reach < grid.y_edges[first] || centre.y - reach > grid.y_edges[end]) return;
  const Range rows = centres_within(grid.y_edges, centre.y - reach, centre.y + reach);
  for (int y = std::max(rows.first, first); y < std::min(rows.end, end); ++y) {
    const float dy = grid.tangent(disc.x, y).y - centre.y;
    const float chord = std::sqrt(std::max(reach * reach - dy * dy, 0.0F));
    const Range columns = centres_within(grid.x_edges, centre.x - chord, centre.x + chord);
    const auto depths = depth_m.row(y);
    const auto marks = out.row(y);
    for (int x = columns.first; x < columns.end; ++x) {
      const float in_front = inverse_of(depths[x]) - disc.far_inverse;
      if (in_front >= half_cell(grid, x, y, radius_m)) marks[x] = 1;
    }
  }
}

}  // namespace

float far_limit(const PixelGrid& grid, int x, int y, float near, double radius_m) {
  return near - half_cell(grid, x, y, radius_m);
}

void find_band(const image::Plane<float>& depth_m, const PixelGrid& grid, double radius_m,
               scheduling::TileScheduler& scheduler, Band& out) {
  MACULA_CHECK(radius_m > 0.0, "a view cell has a size");
  MACULA_CHECK(depth_m.width() == grid.width() && depth_m.height() == grid.height());
  out.resize(grid.width(), grid.height());
  const auto tiles = static_cast<std::size_t>((grid.height() + kTileRows - 1) / kTileRows);
  std::vector<std::vector<Disc>> discs(tiles);
  const auto rows_of = [&](std::size_t tile) {
    const int first = static_cast<int>(tile) * kTileRows;
    return Range{first, std::min(first + kTileRows, grid.height())};
  };
  scheduler.run(tiles, [&](std::size_t tile) {
    const Range rows = rows_of(tile);
    for (int y = rows.first; y < rows.end; ++y) add_discs(depth_m, grid, radius_m, y, discs[tile]);
  });
  scheduler.run(tiles, [&](std::size_t tile) {
    const Range rows = rows_of(tile);
    for (const auto& some : discs) {
      for (const Disc& disc : some) mark(disc, depth_m, grid, radius_m, rows.first, rows.end, out);
    }
  });
}

}  // namespace macula::disocclusion
