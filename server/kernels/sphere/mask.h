// Mask: the cells of a view that are traced at full level in one frame, and the cells of the middle
// level that the others need. Pure functions of the view, the frame and the low level's edges.
#pragma once

#include "server/kernels/kernel.h"
#include "server/kernels/sphere/config.h"
#include "server/kernels/sphere/levels.h"

namespace macula::kernels::sphere {

/// Whether importance can thin anything out: some cell lies outside the fovea and is smaller than
/// what the middle level would put in its place.
bool may_thin(const View& view, const MaskConfig& config);

/// 1 where a cell is important: `importance` of its eccentricity and of the low cell above it, held
/// against its threshold. On a grid with cells of several sizes a cell is the more important the
/// larger it is, and always where it is as large as four of the smallest: the grid has thinned it.
Plane<std::uint8_t> important_cells(const View& view, const Plane<float>& edges,
                                    std::uint64_t frame, std::uint64_t seed,
                                    const MaskConfig& config, TileScheduler& scheduler);

/// Average where all cells under one of the middle level are important, else Traced.
Plane<MidSource> mid_sources(const Plane<std::uint8_t>& important);

}  // namespace macula::kernels::sphere
