// Wall time of one stage of a frame after another. One thread.
#pragma once

#include <chrono>

#include "shared/units/time.h"

namespace macula::kernels::culling {

class StageClock {
 public:
  /// Since the last lap, or since it was made.
  double lap_ms() {
    const auto now = std::chrono::steady_clock::now();
    const double spent = units::to_ms(now - begin_);
    begin_ = now;
    return spent;
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace macula::kernels::culling
