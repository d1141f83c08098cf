// `macula-bench motion`: what a moment of a moving scene costs, part by part: posing, transforms
// and the top level, refits against rebuilds, light lists. CPU time of all threads, milliseconds.
#pragma once

#include <string>

#include "shared/base/result.h"

namespace macula::bench {

struct MotionOptions {
  bool quick = false;  ///< small scenes, few repetitions
  std::string json;    ///< report; empty: none
};

Result<void> run_motion(const MotionOptions& options);

}  // namespace macula::bench
