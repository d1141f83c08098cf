#include "client/pose/gaze_source.h"

#include <cmath>
#include <numbers>

namespace macula::pose {

GazeSample GazeOfHead::sample(ClientTime at, const Pose&) {
  const auto head = source_->sample(at);
  if (!head) return {{.valid = false, .confidence = 0.0F}, at};
  return {head->gaze, head->gaze_at};
}

DVec3 TargetGaze::target(Nanoseconds since) {
  constexpr double kDistance_m = 2.0, kEyeLevel_m = 1.6;
  const auto swing = [&](double degrees, double period_s) {
    const double phase = 2.0 * std::numbers::pi * units::to_s(since) / period_s;
    return kDistance_m * std::tan(Radians(Degrees{degrees}).value()) * std::sin(phase);
  };
  return {swing(20.0, 8.0), kEyeLevel_m + swing(10.0, 5.0), -kDistance_m};
}

GazeSample TargetGaze::sample(ClientTime at, const Pose& stage_from_head) {
  if (!start_) start_ = at;
  const DVec3 seen = math::inverse(stage_from_head).transform_point(target(at - *start_));
  return {{.direction = Vec3(glm::normalize(seen))}, at};
}

std::optional<HeadSample> HeadWithGaze::sample(ClientTime at) {
  auto head = head_->sample(at);
  if (!head) return std::nullopt;
  const GazeSample gaze = gaze_->sample(at, head->stage_from_head);
  head->gaze = gaze.gaze;
  head->gaze_at = gaze.at;
  return head;
}

}  // namespace macula::pose
