// The levels of the inverted pyramid as grids: a cell of a level covers a square of the grid's own
// cells. The paper's resolutions are shares of the area: 1/16 and 1/4 of the samples.
#pragma once

#include <algorithm>
#include <cstdint>

#include "shared/foveation/pixel_grid.h"
#include "shared/image/color.h"
#include "shared/image/plane.h"

namespace macula::kernels::sphere {

using image::Plane;

inline constexpr int kLowSide = 4;  ///< cells of the grid along a side of a low cell
inline constexpr int kMidSide = 2;

/// Every `side`-th edge of a grid; the last column and row may be narrower.
PixelGrid coarsen(const PixelGrid& grid, int side);

/// 1 / view depth; 0 for +infinity, and finite also for an eye in a solid, whose depth is 0:
/// neighbours are averaged.
inline float inverse_of_depth(float depth_m) {
  constexpr float kLeastDepth = 1e-30F;  // m
  return 1.0F / std::max(depth_m, kLeastDepth);
}

/// Where a cell of the middle level comes from in one frame.
enum class MidSource : std::uint8_t {
  Traced,
  Kept,     ///< from the last frame
  Average,  ///< of its own cells, which are all important
};

/// The middle level of one view: what unimportant cells are drawn from, and what is kept for the
/// next frame.
struct MidLevel {
  Plane<MidSource> source;
  Plane<Rgb> radiance;
  Plane<float> inverse_depth;       ///< 1 / view depth, 1/m; 0 where nothing was hit
  Plane<std::uint8_t> age;          ///< frames since it was traced
  Plane<std::uint32_t> surface_id;  ///< as ViewBuffers has it
  Plane<Vec3> normal;
  Plane<Rgb> albedo;
  Plane<float> steps;

  void resize(int width, int height);
};

}  // namespace macula::kernels::sphere
