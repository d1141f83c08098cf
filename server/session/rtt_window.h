// Round-trip time of frames: from the last byte handed to the network to the acknowledgement's
// arrival. The minimum over a sliding window is the link without its queues and the client's
// pauses. A value: one owner, no clock of its own, at most 64 samples.
#pragma once

#include <deque>
#include <optional>

#include "shared/units/time.h"

namespace macula::session {

class RttWindow {
 public:
  /// Negative samples (events that overtook each other) are ignored.
  void add(Nanoseconds rtt, ServerTime at);
  /// Least sample of the last 10 s before `now`; nullopt when there is none.
  std::optional<Nanoseconds> least(ServerTime now) const;

 private:
  struct Sample {
    Nanoseconds rtt;
    ServerTime at;
  };
  std::deque<Sample> rising_;  ///< rtt rises from front to back: the front is the least
};

}  // namespace macula::session
