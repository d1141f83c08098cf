// Marches lanes to their end, slab by slab from the nearest. Inside server/sdf.
#pragma once

#include "server/sdf/scratch.h"

namespace macula::sdf {

/// Work of one kind.
struct MarchWork {
  std::uint64_t evaluations = 0, operations = 0;
};

/// Every lane that waits in scratch.block_slabs, with their tapes; lane `id` ends in
/// scratch.results[id]. `limits` but for the slabs' ranges. Hits are left in their slabs.
MarchWork march(Stepping stepping, MarchLimits limits, TraceScratch& scratch);

}  // namespace macula::sdf
