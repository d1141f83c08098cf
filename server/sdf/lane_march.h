// Marches lanes to their end, slab by slab from the nearest, and finds the surfaces they hit.
// Inside server/sdf.
#pragma once

#include "server/sdf/scratch.h"

namespace macula::sdf {

/// Every lane of scratch.lanes from where it stands, with the tapes of scratch.block_slabs.
/// `limits` are those of rays; the slabs' ranges are filled in. Adds to `evaluations` and
/// `operations`. Hits are left in their slabs.
void march(Stepping stepping, MarchLimits limits, TraceScratch& scratch, std::uint64_t& evaluations,
           std::uint64_t& operations);

/// Normal and material of every hit lane into hits[lane]; moves its t onto the surface by one
/// Newton step along the ray of a few hit distances at most.
void find_surfaces(float hit_m, TraceScratch& scratch, std::vector<Hit>& hits, TraceCounts& counts);

}  // namespace macula::sdf
