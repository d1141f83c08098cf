#include "client/pose/predictor.h"

#include <algorithm>

#include "shared/base/check.h"

namespace macula::pose {
namespace {

struct Velocity {
  DVec3 linear_m_per_s{0.0};
  DVec3 axis{0.0, 1.0, 0.0};    // stage frame, unit
  double turn_rad_per_s = 0.0;  // >= 0 about axis
};

/// Mean velocity that leads from `a` to `b`, along the shorter arc.
Velocity velocity_between(const HeadSample& a, const HeadSample& b) {
  const double seconds = units::to_s(b.at - a.at);
  const Pose &from = a.stage_from_head, &to = b.stage_from_head;
  Velocity velocity{(to.position - from.position) / seconds};
  DQuat turn = to.rotation * glm::conjugate(from.rotation);
  if (turn.w < 0.0) turn = -turn;
  const DVec3 imaginary{turn.x, turn.y, turn.z};
  const double sine = glm::length(imaginary);
  if (sine > 0.0) {
    velocity.axis = imaginary / sine;
    velocity.turn_rad_per_s = 2.0 * std::atan2(sine, turn.w) / seconds;
  }
  return velocity;
}

Velocity clamped(Velocity velocity, const PredictorOptions& options) {
  const double fastest = Radians{options.fastest_turn_per_s}.value();
  velocity.turn_rad_per_s = std::min(velocity.turn_rad_per_s, fastest);
  const double speed = glm::length(velocity.linear_m_per_s);
  const double fastest_move = options.fastest_move_per_s.value();
  if (speed > fastest_move) velocity.linear_m_per_s *= fastest_move / speed;
  return velocity;
}

}  // namespace

void Predictor::add(const HeadSample& sample) {
  if (!samples_.empty() && sample.at <= samples_.back().at) samples_.clear();
  samples_.push_back(sample);
  while (samples_.size() > 2 && sample.at - samples_[1].at >= options_.window) samples_.pop_front();
}

Pose Predictor::predict(ClientTime at) const {
  MACULA_CHECK(!samples_.empty(), "nothing to predict from");
  const HeadSample& newest = samples_.back();
  const auto horizon = std::min(at - newest.at, options_.longest_horizon);
  if (samples_.size() < 2 || horizon <= Nanoseconds{0}) return newest.stage_from_head;
  const Velocity velocity = clamped(velocity_between(samples_.front(), newest), options_);
  const double seconds = units::to_s(horizon);
  const Pose& now = newest.stage_from_head;
  const DQuat turn = glm::angleAxis(velocity.turn_rad_per_s * seconds, velocity.axis);
  return {now.position + seconds * velocity.linear_m_per_s, glm::normalize(turn * now.rotation)};
}

}  // namespace macula::pose
