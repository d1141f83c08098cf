// Predictor: where the head will be when the display lights up, by constant velocity. The velocity
// is taken over the last samples of a short window, the horizon and the speeds are clamped so that
// a glitch of the tracker cannot throw the view. One thread.
#pragma once

#include <deque>

#include "client/pose/pose_source.h"
#include "shared/units/angle.h"
#include "shared/units/length.h"

namespace macula::pose {

struct PredictorOptions {
  Nanoseconds longest_horizon{units::from_ms(100.0)};
  Degrees fastest_turn_per_s{200.0};
  Meters fastest_move_per_s{3.0};
  /// The velocity is the mean over the samples of this window; a longer one is smoother and later.
  Nanoseconds window{units::from_ms(30.0)};
};

class Predictor {
 public:
  explicit Predictor(const PredictorOptions& options = {}) : options_(options) {}

  /// Samples come in rising time; one that does not rise restarts the predictor.
  void add(const HeadSample& sample);
  /// The newest pose carried on to `at`; itself when there is only one sample or `at` is not later.
  /// At least one sample must have been added.
  Pose predict(ClientTime at) const;

 private:
  PredictorOptions options_;
  std::deque<HeadSample> samples_;  // newest last; the first is the youngest one older than window
};

}  // namespace macula::pose
