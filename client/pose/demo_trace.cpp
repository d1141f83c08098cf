#include "client/pose/demo_trace.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shared/base/check.h"
#include "shared/foveation/eccentricity.h"
#include "shared/math/hash.h"

namespace macula::pose {
namespace {

/// A rest of the eyes: `begin` ends the saccade that led here.
struct Fixation {
  double begin_s = 0.0;
  double end_s = 0.0;
  DVec3 stage_direction{0.0, 0.0, -1.0};
};

constexpr double kEyeHeight_m = 1.6;
constexpr Degrees kSmallestSaccade{
    11.0};  // a degree above the promise: samples fall inside saccades
constexpr Degrees kLargestSaccade{32.0};
constexpr Degrees kWidestGaze{24.0};  // eyes are rarely turned further from the head's axis

/// Sines of unrelated periods; the angular speeds add up to at most 46 deg/s.
Pose head_at(double t_s) {
  const auto wave = [t_s](double period_s, double phase) {
    return std::sin(2.0 * std::numbers::pi * t_s / period_s + phase);
  };
  const Radians yaw{Degrees{24.0 * wave(7.3, 0.0) + 5.0 * wave(3.1, 0.7)}};
  const Radians pitch{Degrees{7.0 * wave(5.3, 1.1) - 3.0}};
  const Radians roll{Degrees{2.5 * wave(6.1, 2.0)}};
  const DQuat rotation = glm::angleAxis(yaw.value(), DVec3{0.0, 1.0, 0.0}) *
                         glm::angleAxis(pitch.value(), DVec3{1.0, 0.0, 0.0}) *
                         glm::angleAxis(roll.value(), DVec3{0.0, 0.0, 1.0});
  const DVec3 sway{0.06 * wave(4.7, 0.3), 0.015 * wave(2.3, 0.0), 0.05 * wave(5.9, 1.9)};
  return {DVec3{0.0, kEyeHeight_m, 0.0} + sway, glm::normalize(rotation)};
}

double random(std::uint64_t seed, std::uint64_t fixation, std::uint64_t dimension) {
  return static_cast<double>(
      math::unit_float(math::hash_combine(math::hash_combine(seed, fixation), dimension)));
}

Degrees angle(const DVec3& a, const DVec3& b) {
  return foveation::eccentricity(a, b);
}

double saccade_duration_s(Degrees size) {
  return 0.021 + 0.0022 * size.value();
}

DVec3 direction_in_head(Degrees yaw, Degrees pitch) {
  const double x = std::tan(Radians{yaw}.value()), y = std::tan(Radians{pitch}.value());
  return glm::normalize(DVec3{x, y, -1.0});
}

/// Whether eyes would go from `last` to `candidate` at last.end_s and could stay until `end_s`.
bool is_plausible(const Fixation& last, const DVec3& candidate, double end_s) {
  const Degrees size = angle(last.stage_direction, candidate);
  if (size < kSmallestSaccade || size > kLargestSaccade) return false;
  const auto turned = [&](double t_s) {
    return angle(candidate, head_at(t_s).transform_direction(DVec3{0.0, 0.0, -1.0}));
  };
  return turned(last.end_s) < kWidestGaze && turned(end_s) < kWidestGaze;
}

/// The next rest, by rejection over hashed candidates around where the head points half-way.
Fixation next_fixation(const Fixation& last, std::uint64_t seed, std::uint64_t index) {
  constexpr std::uint64_t kMostTries = 256;
  const double rest_s = 0.52 + 0.42 * random(seed, index, 0);  // end to end: 0.5 to 1 s
  const double end_s = last.end_s + rest_s;
  const Pose halfway = head_at(last.end_s + 0.5 * rest_s);
  for (std::uint64_t i = 0; i < kMostTries; ++i) {
    const Degrees yaw{42.0 * random(seed, index, 2 * i + 1) - 21.0};
    const Degrees pitch{26.0 * random(seed, index, 2 * i + 2) - 14.0};
    const DVec3 candidate = halfway.transform_direction(direction_in_head(yaw, pitch));
    if (!is_plausible(last, candidate, end_s)) continue;
    const double begin_s = last.end_s + saccade_duration_s(angle(last.stage_direction, candidate));
    return {begin_s, end_s, candidate};
  }
  MACULA_CHECK(false, "no plausible saccade: the head turns faster than the eyes may follow");
  return last;
}

std::vector<Fixation> make_fixations(double duration_s, std::uint64_t seed) {
  std::vector<Fixation> fixations{{0.0, 0.6, head_at(0.3).transform_direction(DVec3{0, 0, -1})}};
  while (fixations.back().end_s < duration_s) {
    fixations.push_back(next_fixation(fixations.back(), seed, fixations.size()));
  }
  return fixations;
}

/// Stage direction of the gaze at t: resting, or on the way (smoothstep) to the next fixation.
DVec3 gaze_at(const std::vector<Fixation>& fixations, double t_s) {
  const auto next = std::find_if(fixations.begin(), fixations.end(),
                                 [t_s](const Fixation& f) { return t_s <= f.end_s; });
  const Fixation& now = next == fixations.end() ? fixations.back() : *next;
  if (t_s >= now.begin_s || next == fixations.begin()) return now.stage_direction;
  const Fixation& before = *(next - 1);
  const double share = (t_s - before.end_s) / (now.begin_s - before.end_s);
  const double smooth = share * share * (3.0 - 2.0 * share);
  return glm::normalize(before.stage_direction +
                        smooth * (now.stage_direction - before.stage_direction));
}

}  // namespace

Trace make_demo_trace(const DemoTraceOptions& options) {
  const double duration_s = units::to_s(options.duration);
  MACULA_CHECK(duration_s >= 2.0 && options.rate_hz >= 10.0, "see DemoTraceOptions");
  const auto fixations = make_fixations(duration_s, options.seed);
  Trace trace;
  for (int i = 0;; ++i) {
    const double t_s = i / options.rate_hz;
    if (t_s > duration_s) return trace;
    const Pose head = head_at(t_s);
    const DVec3 gaze = glm::conjugate(head.rotation) * gaze_at(fixations, t_s);
    trace.samples.push_back({units::from_s(t_s), head, Vec3(glm::normalize(gaze))});
  }
}

}  // namespace macula::pose
