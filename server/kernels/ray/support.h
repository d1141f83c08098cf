// Support: the coarse, fixed set of cells that every frame traces (support image and support
// G-buffer of section 3). Its depths, known anew each frame, say where everything lies now; its
// colours fill what nothing else knows. Pixel = floor((i + 0.5) W / Ws), so spacings need not be
// whole. Immutable once filled.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/kernels/kernel.h"
#include "server/kernels/ray/foveated_config.h"
#include "server/kernels/ray/fresh.h"

namespace macula::kernels::ray {

using image::Plane;

/// 1/m, finite for an eye in a surface, too: nothing counts as nearer than a nanometer.
inline float inverse_of(float depth_m) {
  return 1.0F / std::max(depth_m, 1e-9F);
}

/// Support samples along one axis, and where every cell lies between them.
struct SupportAxis {
  std::vector<int> cells;            ///< of the samples, increasing
  std::vector<int> left;             ///< for each cell: sample before it, at most count - 2
  std::vector<float> fraction;       ///< of the way to the next sample, on the tangent plane
  std::vector<std::uint8_t> chosen;  ///< 1 where the cell is a sample

  /// At least one sample; `edges` as in PixelGrid.
  SupportAxis(const std::vector<float>& edges, float spacing);
  int count() const { return static_cast<int>(cells.size()); }
  /// The sample that a chosen cell is.
  int sample(int cell) const { return cells[left[cell]] == cell ? left[cell] : left[cell] + 1; }
  /// Sample after `left`, the same where there is only one.
  int right(int cell) const { return std::min(left[cell] + 1, count() - 1); }
};

struct Support {
  SupportAxis x, y;
  Plane<float> inverse_depth;  ///< 1/m
  Plane<Vec3> normal;          ///< unit, world; 0 where nothing was hit
  /// 1 where the samples at the corners of a quad do not lie on one surface.
  Plane<std::uint8_t> broken;

  Support(const PixelGrid& grid, float spacing);
  bool chosen(int cell_x, int cell_y) const { return x.chosen[cell_x] && y.chosen[cell_y]; }

  /// From the samples of a frame whose support cells have been traced.
  void fill(const FreshSamples& fresh, const FoveatedConfig& config);
  /// Inverse depth at every cell of a row, linear between samples.
  void inverse_depth_row(int cell_y, std::span<float> out) const;
  /// Whether the quad around a cell is broken.
  bool broken_at(int cell_x, int cell_y) const {
    return broken(x.left[cell_x], y.left[cell_y]) != 0;
  }
  /// Inverse depths at the corners of the quad around a cell, nearest first.
  std::array<float, 4> corners(int cell_x, int cell_y) const;

 private:
  void find_broken(float threshold);
};

}  // namespace macula::kernels::ray
