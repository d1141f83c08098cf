// TimeBudget: a budget of rendering time becomes quality: a linear scale of the periphery's
// resolution and of the disc that keeps full resolution around the gaze, so that cells, and with
// them the cost of a frame, go with its square. Proportional control on smoothed render times with
// a dead band; without a target it always answers 1. The governor owns it. Pure.
#pragma once

#include <optional>

#include "shared/units/time.h"

namespace macula::session {

class TimeBudget {
 public:
  static constexpr double kLeastScale = 0.4;

  /// nullopt: off.
  explicit TimeBudget(std::optional<Nanoseconds> target = std::nullopt) : target_(target) {}

  /// Scale of the nominal display's width and height for the next frame, in [kLeastScale, 1], in
  /// steps of 1/20.
  double scale() const;
  /// A frame begun at scale() took `render`.
  void on_frame(Nanoseconds render);

 private:
  static constexpr int kSteps = 20;
  std::optional<Nanoseconds> target_;
  int step_ = kSteps;  ///< scale() = step_ / kSteps
  double smoothed_ms_ = 0.0;
  int frames_at_step_ = 0;
};

}  // namespace macula::session
