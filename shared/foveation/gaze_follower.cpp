#include "shared/foveation/gaze_follower.h"

#include <algorithm>
#include <cmath>

#include "shared/foveation/eccentricity.h"
#include "shared/math/frames.h"

namespace macula::foveation {
namespace {

constexpr Nanoseconds kSpeedWindow = std::chrono::milliseconds{80};
constexpr Vec3 kAxis{0.0F, 0.0F, -1.0F};

double degrees_between(const Vec3& a, const Vec3& b) {
  return Degrees{eccentricity(a, b)}.value();
}

/// From `a` towards `b` by a share of the way; the great circle's chord is near enough.
Vec3 towards(const Vec3& a, const Vec3& b, double share) {
  const Vec3 between = a + static_cast<float>(share) * (b - a);
  const float length = glm::length(between);
  return length > 0.0F ? between / length : b;
}

bool is_usable(const Gaze& gaze) {
  const float length = glm::length(gaze.direction);
  return gaze.valid && math::is_finite(gaze.direction) && std::isfinite(length) && length > 0.0F;
}

}  // namespace

void GazeFollower::add(const Gaze& measured, ClientTime at) {
  if (newest_ && at <= *newest_) return;
  newest_ = at;
  if (!is_usable(measured)) {
    lose(at - usable_at_);
    return;
  }
  confidence_ = measured.confidence;
  take_sample(glm::normalize(measured.direction), at);
}

void GazeFollower::take_sample(const Vec3& direction, ClientTime at) {
  const double passed_s = units::to_s(at - usable_at_);
  const bool was_lost = phase_ == GazePhase::Held || phase_ == GazePhase::Lost;
  const double speed = was_lost ? 0.0 : degrees_between(raw_, direction) / std::max(passed_s, 1e-3);
  usable_at_ = at;
  // A jump is no drift: it counts as its threshold.
  speeds_.push_back({at, std::min(speed, options_.saccade_deg_per_s)});
  while (at - speeds_.front().at > kSpeedWindow) speeds_.pop_front();
  if (speed > options_.saccade_deg_per_s) {
    if (phase_ != GazePhase::Saccade) {
      saccade_from_ = raw_;
      saccade_peak_deg_per_s_ = 0.0;
    }
    if (speed > saccade_peak_deg_per_s_) {
      saccade_peak_deg_per_s_ = speed;
      peak_at_deg_ =
          0.5 * (degrees_between(saccade_from_, raw_) + degrees_between(saccade_from_, direction));
    }
    phase_ = GazePhase::Saccade;
    smooth_ = direction;
  } else {
    const bool is_anew = phase_ != GazePhase::Fixation;
    const double lag_s = units::to_s(options_.lag);
    const double share = is_anew || lag_s <= 0.0 ? 1.0 : 1.0 - std::exp(-passed_s / lag_s);
    smooth_ = towards(smooth_, direction, share);
    phase_ = GazePhase::Fixation;
  }
  raw_ = direction;
}

void GazeFollower::lose(Nanoseconds since_last) {
  phase_ = since_last <= options_.blink ? GazePhase::Held : GazePhase::Lost;
  if (phase_ != GazePhase::Lost) return;
  const double over = units::to_s(since_last - options_.blink) / units::to_s(options_.glide);
  smooth_ = towards(raw_, kAxis, 1.0 - std::exp(-over));
}

/// Never short of where the eye is already.
Vec3 GazeFollower::landing() const {
  const double so_far = degrees_between(saccade_from_, raw_);
  const double amplitude = 2.0 * peak_at_deg_;
  if (so_far <= 0.0 || amplitude <= so_far) return raw_;
  const Vec3 axis = glm::cross(saccade_from_, raw_);
  const float length = glm::length(axis);
  if (length <= 0.0F) return raw_;
  const Vec3 side = glm::cross(axis / length, saccade_from_);
  const double angle = Radians{Degrees{amplitude}}.value();
  return saccade_from_ * static_cast<float>(std::cos(angle)) +
         side * static_cast<float>(std::sin(angle));
}

double GazeFollower::mean_speed() const {
  if (speeds_.empty()) return 0.0;
  double sum = 0.0;
  for (const Speed& speed : speeds_) sum += speed.deg_per_s;
  return sum / static_cast<double>(speeds_.size());
}

FollowedGaze GazeFollower::follow(Nanoseconds age) {
  FollowedGaze followed;
  followed.phase = phase_;
  const bool sees = phase_ == GazePhase::Fixation || phase_ == GazePhase::Saccade;
  followed.gaze = {phase_ == GazePhase::Saccade ? landing() : smooth_, sees,
                   sees ? confidence_ : 0.0F};
  const double off_deg = degrees_between(centre_, followed.gaze.direction);
  if (off_deg > options_.rest.value()) centre_ = followed.gaze.direction;
  followed.centre = followed.gaze;
  followed.centre.direction = centre_;
  const double age_s = std::max(units::to_s(age + options_.lag), 0.0);
  // A saccade's speed is not the landed eye's: the next samples will tell.
  const double speed = phase_ == GazePhase::Fixation ? mean_speed() : 0.0;
  const double radius =
      std::min(options_.base_radius.value() + options_.speed_share * speed * age_s,
               options_.most_radius.value());
  const double aside = degrees_between(centre_, followed.gaze.direction);
  followed.radius = Degrees{radius + aside};
  return followed;
}

}  // namespace macula::foveation
