#include "client/pose/saccades.h"

#include <algorithm>

#include "shared/foveation/eccentricity.h"

namespace macula::pose {

void SaccadeCounter::add(const HeadSample& sample) {
  if (!sample.gaze.valid) return;
  const Look now{sample.gaze_at, sample.gaze.direction};
  while (recent_.size() > 1 && now.at - recent_.front().at > within_) recent_.pop_front();
  const bool in_the_last_jump = last_jump_ && now.at - *last_jump_ < within_;
  const bool moved = std::any_of(recent_.begin(), recent_.end(), [&](const Look& look) {
    return Degrees{foveation::eccentricity(look.direction, now.direction)} > least_;
  });
  if (moved && !in_the_last_jump) {
    ++count_;
    last_jump_ = now.at;
  }
  if (moved || in_the_last_jump) recent_.clear();
  recent_.push_back(now);
}

}  // namespace macula::pose
