// A made-up viewer for demo and tests: stands at the stage's origin, eyes 1.6 m up, sways a few
// centimeters, looks around slowly (never faster than 60 deg/s) and moves the eyes by saccades of
// 10 degrees or more every 0.5 to 1 s. Between saccades the gaze rests on one direction of the
// stage, as eyes do, while the head turns. The saccade's duration is the main sequence's 21 ms
// + 2.2 ms a degree (Carpenter, Movements of the Eyes, 1988). Deterministic: a pure function of the
// options.
#pragma once

#include <cstdint>

#include "client/pose/trace.h"

namespace macula::pose {

struct DemoTraceOptions {
  Nanoseconds duration{units::from_s(20.0)};  ///< at least 2 s
  double rate_hz = 72.0;                      ///< samples a second, at least 10
  std::uint64_t seed = 1;
};

Trace make_demo_trace(const DemoTraceOptions& options = {});

}  // namespace macula::pose
