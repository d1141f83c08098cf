// Detail: blocks of the middle level that differ from one beside them. Between them runs an edge of
// a shape, a pattern or a light that drawing between samples would blur, wherever the eye looks, so
// their cells are traced after all. Pure functions.
#pragma once

#include <cstdint>

#include "server/kernels/kernel.h"
#include "server/kernels/sphere/config.h"
#include "server/kernels/sphere/levels.h"

namespace macula::kernels::sphere {

struct Detail {
  Plane<std::uint8_t> cells;   ///< 1 where a cell is to be traced: never an important one
  Plane<std::uint8_t> blocks;  ///< of the middle level: 1 where they hold such cells
};

/// Blocks whose lightness differs by more than `contrast` from that of one of the four beside them.
/// Lightness is the square root of tone-mapped luminance (Hunter 1948), [0, 1]. `mid` is finished.
Detail find_detail(const MidLevel& mid, const Plane<std::uint8_t>& important,
                   const image::Tone& tone, float contrast, TileScheduler& scheduler);

}  // namespace macula::kernels::sphere
