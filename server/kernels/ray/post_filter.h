// Post filter (section 3.5): a resampled cell's light, one noisy estimate, gives way to that of the
// closest cell that was not resampled, found by random probes. Pure.
#pragma once

#include "server/kernels/ray/merge.h"

namespace macula::kernels::ray {

/// Light for cell (x, y); its own where no other is near. Reads cells that were not resampled only.
Rgb neighbours_light(const MergeJob& job, const Cache& cache, int x, int y);

}  // namespace macula::kernels::ray
