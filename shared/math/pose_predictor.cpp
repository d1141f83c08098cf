#include "shared/math/pose_predictor.h"

#include <algorithm>
#include <cmath>

#include "shared/base/check.h"

namespace macula::math {

/// Mean velocity that leads from `a` to `b`, along the shorter arc.
PosePredictor::Velocity PosePredictor::velocity_between(const Sample& a, const Sample& b) {
  const double seconds = units::to_s(b.at - a.at);
  Velocity velocity{(b.pose.position - a.pose.position) / seconds};
  DQuat turn = b.pose.rotation * glm::conjugate(a.pose.rotation);
  if (turn.w < 0.0) turn = -turn;
  const DVec3 imaginary{turn.x, turn.y, turn.z};
  const double sine = glm::length(imaginary);
  if (sine > 0.0) {
    velocity.axis = imaginary / sine;
    velocity.turn_rad_per_s = 2.0 * std::atan2(sine, turn.w) / seconds;
  }
  return velocity;
}

PosePredictor::Velocity PosePredictor::velocity() const {
  if (samples_.size() < 2) return {};
  Velocity velocity = velocity_between(samples_.front(), samples_.back());
  const double fastest = Radians{options_.fastest_turn_per_s}.value();
  velocity.turn_rad_per_s = std::min(velocity.turn_rad_per_s, fastest);
  const double speed = glm::length(velocity.linear_m_per_s);
  const double fastest_move = options_.fastest_move_per_s.value();
  if (speed > fastest_move) velocity.linear_m_per_s *= fastest_move / speed;
  return velocity;
}

void PosePredictor::add(ClientTime at, const Pose& pose) {
  if (!samples_.empty() && at <= samples_.back().at) samples_.clear();
  samples_.push_back({at, pose});
  while (samples_.size() > 2 && at - samples_[1].at >= options_.window) samples_.pop_front();
}

Pose PosePredictor::predict(ClientTime at) const {
  MACULA_CHECK(!samples_.empty(), "nothing to predict from");
  const Sample& newest = samples_.back();
  const auto horizon = std::min(at - newest.at, options_.longest_horizon);
  if (samples_.size() < 2 || horizon <= Nanoseconds{0}) return newest.pose;
  const Velocity velocity = this->velocity();
  const double seconds = units::to_s(horizon);
  const DQuat turn = glm::angleAxis(velocity.turn_rad_per_s * seconds, velocity.axis);
  return {newest.pose.position + seconds * velocity.linear_m_per_s,
          glm::normalize(turn * newest.pose.rotation)};
}

Degrees PosePredictor::turn_per_s() const {
  return Degrees{Radians{velocity().turn_rad_per_s}};
}

Meters PosePredictor::move_per_s() const {
  return Meters{glm::length(velocity().linear_m_per_s)};
}

}  // namespace macula::math
