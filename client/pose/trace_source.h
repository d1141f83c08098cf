// TraceSource plays a trace on the caller's time line: the first sample() call is the trace's
// start, and every later one is as far into the trace as its time is after the first. On the client
// clock that is real time; a caller that hands in evenly stepped times plays as fast as it likes.
// One thread.
#pragma once

#include <optional>

#include "client/pose/pose_source.h"
#include "client/pose/trace.h"

namespace macula::pose {

enum class AtEnd { Stop, Loop };

class TraceSource final : public PoseSource {
 public:
  explicit TraceSource(Trace trace, AtEnd at_end = AtEnd::Stop);
  /// nullopt after the last sample, unless looping (which jumps back to the first).
  std::optional<HeadSample> sample(ClientTime at) override;

 private:
  Trace trace_;
  AtEnd at_end_;
  std::optional<ClientTime> start_;
};

}  // namespace macula::pose
