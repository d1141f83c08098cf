// Edges of the low level: where neighbouring samples, one in the middle of every cell of its grid,
// see different things. Paper 2023 section 3.2.2, corrected: README.md. Pure.
#pragma once

#include "server/kernels/sphere/config.h"
#include "shared/foveation/pixel_grid.h"
#include "shared/image/color.h"
#include "shared/image/plane.h"

namespace macula::kernels::sphere {

using image::Plane;

/// What the low level saw.
struct LowLevel {
  Plane<float> inverse_depth;  ///< 1 / view depth; 0 where nothing was hit, 1/m
  Plane<float> distance;       ///< along the unit ray, +infinity where nothing was hit, m
  Plane<float> luminance;      ///< of albedo or of tone-mapped radiance; empty: depth alone counts
};

/// 1 where a cell or one of its eight neighbours differs from its own neighbours, else 0: a low
/// cell locates an edge only to its own width, hence the border of one.
Plane<float> find_edges(const LowLevel& low, const PixelGrid& low_grid, const MaskConfig& config);

}  // namespace macula::kernels::sphere
