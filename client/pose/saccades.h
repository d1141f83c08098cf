// SaccadeCounter: how often the gaze jumped. A jump is a turn of more than 10 degrees in the head
// frame within 100 ms, or between two samples that lie further apart than that; for the next 100
// ms, the rest of a large saccade, nothing counts.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "client/pose/pose_source.h"
#include "shared/units/angle.h"

namespace macula::pose {

class SaccadeCounter {
 public:
  explicit SaccadeCounter(Degrees least = Degrees{10.0}, Nanoseconds within = units::from_ms(100.0))
      : least_(least), within_(within) {}

  /// Samples in rising time; invalid gazes are passed over.
  void add(const HeadSample& sample);
  std::uint64_t count() const { return count_; }

 private:
  struct Look {
    ClientTime at;
    Vec3 direction;
  };
  Degrees least_;
  Nanoseconds within_;
  std::deque<Look> recent_;  // no older than within_, but always the last
  std::optional<ClientTime> last_jump_;
  std::uint64_t count_ = 0;
};

}  // namespace macula::pose
