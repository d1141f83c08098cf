// A recorded head, moved so that it stands and looks where a scene's camera does.
#pragma once

#include <vector>

#include "client/pose/trace.h"
#include "shared/math/pose.h"

namespace macula::bench {

/// Of the head, that prediction sees.
inline constexpr double kHeadSamplesPerSecond = 72.0;

class RecordedHead {
 public:
  /// `trace` outlives it.
  RecordedHead(const pose::Trace& trace, const Pose& stage_from_camera)
      : trace_(trace), camera_(stage_from_camera) {}

  /// Even moments of the ten most vigorous seconds, the first half a second in.
  std::vector<double> moments(int count) const;
  Pose at(double s) const { return raw(s).stage_from_head; }
  /// What pose::Predictor says at `known_s` about `asked_s`.
  Pose predicted(double known_s, double asked_s) const;
  /// Carries the trace's stage to the scene's: the head of `now_s` stands at the camera's place and
  /// looks along it, as level as recorded.
  Pose stage_from_trace(double now_s) const;

 private:
  pose::HeadSample raw(double s) const { return trace_.at(units::from_s(s)); }
  double most_vigorous(double length_s) const;

  const pose::Trace& trace_;
  const Pose camera_;
};

}  // namespace macula::bench
