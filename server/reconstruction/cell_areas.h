// CellAreas: how large the cells of a grid are, and what the memory of one is worth to another.
#pragma once

#include <algorithm>
#include <vector>

#include "shared/foveation/pixel_grid.h"

namespace macula::reconstruction {

class CellAreas {
 public:
  CellAreas() = default;
  explicit CellAreas(const PixelGrid& grid)
      : width_(steps(grid.x_edges)), height_(steps(grid.y_edges)) {}

  /// On the tangent plane.
  float at(int x, int y) const {
    return width_[static_cast<std::size_t>(x)] * height_[static_cast<std::size_t>(y)];
  }

 private:
  static std::vector<float> steps(const std::vector<float>& edges) {
    std::vector<float> all(edges.size() - 1);
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = edges[i + 1] - edges[i];
    return all;
  }

  std::vector<float> width_, height_;
};

/// Share of a wide cell's samples that lie in a small one, at most 1.
inline float worth(float area_now, float area_then) {
  return std::min(1.0F, area_now / area_then);
}

}  // namespace macula::reconstruction
