// Denoiser: light over reflectance of one view, joined with what earlier frames found on the same
// surfaces and smoothed along them, further where the eye sees less and where little is remembered.
// Biased. Sources: Schied et al. 2017; `reconstruction/atrous.h` and `light_memory.h` have the
// steps.
#pragma once

#include "server/kernels/lightcuts/surfaces.h"
#include "server/reconstruction/light_memory.h"

namespace macula::kernels::lightcuts {

using image::Plane;
using reconstruction::LightMemory;

struct DenoiseJob {
  const View& view;
  const ViewSurfaces& surfaces;
  const Plane<float>& eccentricity;     ///< radians
  const Plane<std::uint16_t>& samples;  ///< of each cell, >= 1
  LightMemory* last = nullptr;  ///< none: of this frame alone; rows that others made come here
};
/// Rows to either side of a cell that its light may come from.
inline constexpr int kDenoiseReach = 32;

/// `light`, linear, of the cells with a surface; others are left alone. `memory` is for the next
/// frame. Where the frame is shared, each rank needs the light of its own band (RowBands) and of
/// kDenoiseReach rows around it, and has its own band's, and the memory's, afterwards.
scheduling::Outcome denoise(const DenoiseJob& job, TileScheduler& scheduler, Plane<Rgb>& light,
                            LightMemory& memory);

}  // namespace macula::kernels::lightcuts
