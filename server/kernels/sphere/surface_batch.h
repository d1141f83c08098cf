// SurfaceBatch: points of a distance field that rays have met, side by side, ready to be lit.
// Positions are relative to the view's eye, in the world's orientation, meters.
#pragma once

#include <cstddef>
#include <cstdint>

#include "server/kernels/scene_frame.h"
#include "server/sampling/batch.h"
#include "server/sampling/sample.h"

namespace macula::kernels::sphere {

/// Entries beyond `count` are read and overwritten: make it zero before first use.
struct SurfaceBatch {
  std::size_t count = 0;
  sampling::Vec3Batch position;
  sampling::Vec3Batch normal;        ///< unit, out of the solid
  sampling::Vec3Batch to_eye;        ///< unit
  sampling::FloatBatch footprint_m;  ///< width at the point of what the sample stands for
  sampling::FloatBatch cell_m;       ///< width at the point of the cell that was traced
  scene::Index material[sampling::kBatch];
  /// Identity of their random numbers; which sample of that identity they are.
  sampling::SampleKey keys[sampling::kBatch];
  std::uint32_t sample[sampling::kBatch];
};

}  // namespace macula::kernels::sphere
