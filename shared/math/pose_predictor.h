// PosePredictor: where a head will be, by constant velocity. The velocity is taken over the last
// samples of a short window; the horizon and the speeds are clamped so that a glitch of the tracker
// cannot throw the view. The client asks it about the display, the server about the frame. One
// thread.
#pragma once

#include <deque>

#include "shared/math/pose.h"
#include "shared/units/angle.h"
#include "shared/units/length.h"
#include "shared/units/time.h"

namespace macula::math {

struct PosePredictorOptions {
  Nanoseconds longest_horizon{units::from_ms(100.0)};
  Degrees fastest_turn_per_s{200.0};
  Meters fastest_move_per_s{3.0};
  /// The velocity is the mean over the samples of this window; a longer one is smoother and later.
  Nanoseconds window{units::from_ms(30.0)};
};

class PosePredictor {
 public:
  explicit PosePredictor(const PosePredictorOptions& options = {}) : options_(options) {}

  /// Samples come in rising time; one that does not rise restarts the predictor.
  void add(ClientTime at, const Pose& pose);
  /// The newest pose carried on to `at`; itself when there is only one sample or `at` is not later.
  /// At least one sample must have been added.
  Pose predict(ClientTime at) const;
  /// Of the window, clamped; 0 with fewer than two samples.
  Degrees turn_per_s() const;
  Meters move_per_s() const;

 private:
  struct Sample {
    ClientTime at{};
    Pose pose;
  };
  struct Velocity {
    DVec3 linear_m_per_s{0.0};
    DVec3 axis{0.0, 1.0, 0.0};    ///< stage frame, unit
    double turn_rad_per_s = 0.0;  ///< >= 0 about axis
  };
  static Velocity velocity_between(const Sample& a, const Sample& b);
  Velocity velocity() const;

  PosePredictorOptions options_;
  std::deque<Sample> samples_;  // newest last; the first is the youngest one older than window
};

}  // namespace macula::math
