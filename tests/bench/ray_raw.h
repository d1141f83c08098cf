// How fast this machine traces the rays of a frame when nothing else is done: the denominator that
// tells whether the full renderer is an honest baseline.
#pragma once

#include "tests/bench/ray_setting.h"

namespace macula::bench {

/// Millions of rays a second of CPU time in bare queries: every primary ray of the view, and from
/// what it meets as many shadow rays as the lighting has.
double raw_mrays_per_s(const RaySetting& setting, const kernels::View& view,
                       scheduling::TileScheduler& scheduler);

}  // namespace macula::bench
