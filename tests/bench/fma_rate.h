// How fast this machine multiplies and adds: the bound that PERFORMANCE sets evaluations of a
// distance field against. A bare loop of independent fused multiply-adds in the widest vectors, on
// as many threads as what is compared with it.
#pragma once

#include "server/scheduling/tile_scheduler.h"

namespace macula::bench {

/// Lanes' fused multiply-adds per second of CPU time, the best of several tries of some
/// milliseconds each. Whatever runs beside it on the machine takes its share of it.
double fma_lanes_per_cpu_s(scheduling::TileScheduler& scheduler);

}  // namespace macula::bench
