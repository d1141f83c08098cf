// The rays of one block of cells, from where they are aimed to what they hit. Inside server/sdf.
#pragma once

#include "server/sdf/lane_march.h"

namespace macula::sdf {

/// Of a hit distance at unit t, or crossings would lie beyond kCrossingReach of their marks: here a
/// surface that falls off by a thirtieth of the way is still crossed. Cells of a picture would want
/// more from a ninth of a degree on.
inline constexpr float kMostHitWidth = 0x1p-13F;

struct RayBlock {
  const PixelGrid& grid;
  const Mat3& scene_from_view;
  image::Rect cells;
  int samples = 1;
  float hit_pixels = 0.0F;
};

/// Directions, hit distances and identities of the samples of the cells that `wanted` (row by row)
/// wants, into scratch.rays, widths and block.hits; returns how many.
std::size_t aim_rays(const RayBlock& block, TraceScratch& scratch);
/// Rays [first, first + count) of scratch start at `start`, up to which everything is free.
void send_rays(std::size_t first, std::size_t count, float start, TraceScratch& scratch);
/// Ends them as misses without an evaluation.
void drop_rays(std::size_t first, std::size_t count, TraceScratch& scratch);
/// scratch.results into scratch.block.hits, without surfaces; counts what is odd.
void take_results(TraceScratch& scratch, TraceCounts& counts);

}  // namespace macula::sdf
