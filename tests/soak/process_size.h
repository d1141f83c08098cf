// What a process holds, as Linux tells it, and how that grows.
#pragma once

#include <sys/types.h>

#include <vector>

namespace macula::soak {

struct ProcessSize {
  double at_s = 0.0;
  double resident_mb = 0.0;
  int descriptors = 0, threads = 0;
};

/// Of a living process; at_s is the caller's.
ProcessSize size_of(pid_t process, double at_s);

/// Median of the slopes between all pairs (Theil 1950, Sen 1968): what is held for a moment longer,
/// here and there, does not tilt it. 0 of fewer than two moments.
double resident_slope_mb_per_h(const std::vector<ProcessSize>& sizes);

}  // namespace macula::soak
