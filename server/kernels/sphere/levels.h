// The levels of the inverted pyramid as grids: a cell of a level covers a square of the grid's own
// cells. The paper's resolutions are shares of the area: 1/16 and 1/4 of the samples.
#pragma once

#include <algorithm>

#include "shared/foveation/pixel_grid.h"

namespace macula::kernels::sphere {

inline constexpr int kLowSide = 4;  ///< cells of the grid along a side of a low cell
inline constexpr int kMidSide = 2;

/// Every `side`-th edge of a grid; the last column and row may be narrower.
inline PixelGrid coarsen(const PixelGrid& grid, int side) {
  const auto thin = [side](const std::vector<float>& edges) {
    std::vector<float> kept;
    for (std::size_t i = 0; i + 1 < edges.size(); i += static_cast<std::size_t>(side))
      kept.push_back(edges[i]);
    kept.push_back(edges.back());
    return kept;
  };
  return {thin(grid.x_edges), thin(grid.y_edges)};
}

}  // namespace macula::kernels::sphere
