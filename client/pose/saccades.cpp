#include "client/pose/saccades.h"

#include <algorithm>

#include "shared/foveation/eccentricity.h"

namespace macula::pose {

void SaccadeCounter::add(const HeadSample& sample) {
  const ClientTime at = sample.gaze_at;
  if (!sample.gaze.valid || (last_jump_ && at - *last_jump_ < within_)) return;
  while (recent_.size() > 1 && at - recent_.front().at > within_) recent_.pop_front();
  const Vec3 direction = sample.gaze.direction;
  const bool jumped = std::any_of(recent_.begin(), recent_.end(), [&](const Look& look) {
    return Degrees{foveation::eccentricity(look.direction, direction)} > least_;
  });
  if (jumped) {
    ++count_;
    last_jump_ = at;
    recent_.clear();
  }
  recent_.push_back({at, direction});
}

}  // namespace macula::pose
