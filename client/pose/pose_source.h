// PoseSource: where head and gaze come from. One sample per refresh; all in the stage frame.
#pragma once

#include <optional>
#include <vector>

#include "shared/base/result.h"
#include "shared/foveation/gaze.h"
#include "shared/math/pose.h"
#include "shared/units/time.h"

namespace macula::pose {

struct HeadSample {
  ClientTime at{};
  Pose stage_from_head;
  Gaze gaze;  ///< in the head frame; sources with two eyes give the mean direction
  ClientTime gaze_at{};
};

class PoseSource {
 public:
  virtual ~PoseSource() = default;
  /// The head at `at` (now or a predicted display time). nullopt when the source has ended.
  virtual std::optional<HeadSample> sample(ClientTime at) = 0;
  /// stage_from_head at a time to come, where the source knows better than an extrapolation.
  virtual std::optional<Pose> forecast(ClientTime /*at*/) { return std::nullopt; }
};

}  // namespace macula::pose
