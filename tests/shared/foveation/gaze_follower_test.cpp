// The gaze followed: known motions of an eye, and recorded ones.
#include "shared/foveation/gaze_follower.h"

#include <gtest/gtest.h>

#include <cmath>

#include "shared/foveation/eccentricity.h"
#include "shared/foveation/pixel_grid.h"
#include "tests/support/recorded_gazes.h"

namespace macula::foveation {
namespace {

using namespace std::chrono_literals;

Vec3 at_yaw(double yaw_deg) {
  const double yaw = Radians{Degrees{yaw_deg}}.value();
  return {static_cast<float>(std::sin(yaw)), 0.0F, static_cast<float>(-std::cos(yaw))};
}
double yaw_deg(const Gaze& gaze) {
  return Degrees{Radians{std::atan2(static_cast<double>(gaze.direction.x),
                                    static_cast<double>(-gaze.direction.z))}}
      .value();
}
ClientTime at(Nanoseconds t) {
  return ClientTime{1s + t};
}

/// Fed at 200 samples a second with yaw(t), t in seconds.
template <class Yaw>
GazeFollower fed(Yaw&& yaw, Nanoseconds until, const GazeFollowerOptions& options = {}) {
  GazeFollower follower(options);
  for (Nanoseconds t = 0ms; t <= until; t += 5ms) {
    follower.add({at_yaw(yaw(units::to_s(t)))}, at(t));
  }
  return follower;
}

TEST(GazeFollower, AnEyeAtRestHasTheBaseRadiusWhateverTheAge) {
  GazeFollower follower = fed([](double) { return 7.0; }, 300ms);
  for (const Nanoseconds age : {0ms, 60ms, 500ms}) {
    const FollowedGaze followed = follower.follow(age);
    EXPECT_NEAR(followed.radius.value(), 5.0, 1e-3);
    EXPECT_NEAR(yaw_deg(followed.gaze), 7.0, 1e-3);
    EXPECT_EQ(followed.phase, GazePhase::Fixation);
    EXPECT_TRUE(followed.gaze.valid);
  }
}

// At 40 deg/s the eye goes 40 x (60 ms + 8 ms of lag) x .5 = 1.36 degrees in the share asked for.
TEST(GazeFollower, TheRadiusGrowsWithSpeedTimesAge) {
  GazeFollower follower = fed([](double t) { return 40.0 * t; }, 300ms);
  EXPECT_NEAR(follower.follow(60ms).radius.value(), 5.0 + 0.5 * 40.0 * 0.068, 0.05);
  EXPECT_NEAR(follower.follow(160ms).radius.value(), 5.0 + 0.5 * 40.0 * 0.168, 0.05);
  EXPECT_EQ(follower.follow(10s).radius.value(), 12.0) << "however long";
}

// A ramp through a one-pole filter comes out tau late, exactly once it has settled; discretely,
// T (1 - s) / s with s = 1 - exp(-T / tau).
TEST(GazeFollower, TheFilterLagsByWhatItSays) {
  GazeFollower follower = fed([](double t) { return 40.0 * t; }, 300ms, {.lag = 20ms});
  const double lag_s = (40.0 * 0.3 - yaw_deg(follower.follow(0ms).gaze)) / 40.0;
  EXPECT_NEAR(lag_s, 0.020, 0.003);
}

/// Minimum-jerk saccade of `amplitude`, from 100 ms on, over 21 ms + 2.2 ms a degree.
double saccade(double t, double amplitude_deg) {
  const double u = std::clamp((t - 0.1) / (0.021 + 0.0022 * amplitude_deg), 0.0, 1.0);
  return amplitude_deg * u * u * u * (10.0 - 15.0 * u + 6.0 * u * u);
}

TEST(GazeFollower, ASaccadeIsSeenAndItsLandingForetoldCloserThanTheEyeIs) {
  for (const double amplitude : {8.0, 12.0, 20.0}) {
    const double middle_s = 0.1 + 0.5 * (0.021 + 0.0022 * amplitude);
    const auto half_way = std::chrono::milliseconds{5 + 5 * std::lround(middle_s * 200.0)};
    GazeFollower follower = fed([&](double t) { return saccade(t, amplitude); }, half_way);
    const FollowedGaze followed = follower.follow(30ms);
    EXPECT_EQ(followed.phase, GazePhase::Saccade);
    const double eye_is_off = amplitude - saccade(units::to_s(half_way), amplitude);
    EXPECT_LT(std::abs(yaw_deg(followed.gaze) - amplitude), eye_is_off) << amplitude << " deg";
    GazeFollower landed = fed([&](double t) { return saccade(t, amplitude); }, 250ms);
    EXPECT_EQ(landed.follow(30ms).phase, GazePhase::Fixation);
    EXPECT_NEAR(yaw_deg(landed.follow(30ms).gaze), amplitude, 0.1);
  }
}

TEST(GazeFollower, APursuitIsNoSaccade) {
  GazeFollower follower = fed([](double t) { return 60.0 * t; }, 400ms);
  EXPECT_EQ(follower.phase(), GazePhase::Fixation);
}

TEST(GazeFollower, ABlinkHoldsTheGazeAndALostOneGlidesToTheMiddle) {
  GazeFollower follower = fed([](double) { return 20.0; }, 100ms);
  Gaze lost;
  lost.valid = false;
  const auto lose_until = [&](Nanoseconds from, Nanoseconds until) {
    for (Nanoseconds t = from; t <= until; t += 5ms) follower.add(lost, at(t));
  };
  lose_until(105ms, 490ms);
  EXPECT_EQ(follower.follow(0ms).phase, GazePhase::Held);
  EXPECT_NEAR(yaw_deg(follower.follow(0ms).gaze), 20.0, 1e-3);
  EXPECT_FALSE(follower.follow(0ms).gaze.valid);
  lose_until(495ms, 800ms);
  EXPECT_EQ(follower.follow(0ms).phase, GazePhase::Lost);
  EXPECT_NEAR(yaw_deg(follower.follow(0ms).gaze), 20.0 / std::exp(1.0), 0.7);
  lose_until(805ms, 3000ms);
  EXPECT_NEAR(yaw_deg(follower.follow(0ms).gaze), 0.0, 0.1);
  follower.add({at_yaw(-9.0)}, at(3005ms));
  EXPECT_NEAR(yaw_deg(follower.follow(0ms).gaze), -9.0, 1e-3) << "found again, at once";
  EXPECT_EQ(follower.follow(0ms).phase, GazePhase::Fixation);
}

TEST(GazeFollower, TheCentreRestsUntilTheGazeHasLeftItAndTheDiscCoversBoth) {
  GazeFollower follower({.rest = Degrees{2.0}});
  double moves = 0.0, last = 0.0;
  for (int i = 0; i <= 400; ++i) {
    const double yaw = 0.01 * i;  // 4 degrees, slowly
    follower.add({at_yaw(yaw)}, at(i * 20ms));
    const FollowedGaze followed = follower.follow(0ms);
    const double centre = yaw_deg(followed.centre);
    moves += centre != last ? 1.0 : 0.0;
    last = centre;
    EXPECT_GE(followed.radius.value() + 1e-3, 5.0 + std::abs(yaw_deg(followed.gaze) - centre));
    EXPECT_LE(std::abs(yaw_deg(followed.gaze) - centre), 2.0 + 1e-3);
  }
  EXPECT_EQ(moves, 1.0);
}

TEST(GazeFollower, NonsenseIsALostGaze) {
  GazeFollower follower;
  follower.add({Vec3{std::nanf(""), 0.0F, -1.0F}}, at(0ms));
  EXPECT_FALSE(follower.follow(0ms).gaze.valid);
  EXPECT_NEAR(yaw_deg(follower.follow(0ms).gaze), 0.0, 1e-6);
}

double degrees(const Vec3& a, const Vec3& b) {
  return Degrees{eccentricity(a, b)}.value();
}

/// Of frames seen 60 ms after their gaze, without those a saccade (100 deg/s) fell into: shares of
/// true gazes outside the disc, and cells of the grid.
struct Misses {
  double frames = 0.0, fixed = 0.0, grown = 0.0, fixed_cells = 0.0, grown_cells = 0.0;
};
void count_misses(const std::vector<test::RecordedGaze>& samples, Degrees base, Misses& misses) {
  const Display display{math::symmetric_fov(Degrees{90.0}, 1.0), 720, 720};
  const auto cells = [&](const FollowedGaze& followed, Degrees radius) {
    const PixelGrid grid =
        make_foveal_grid(display, followed.gaze, RateModel{}, {.full_rate_radius = radius});
    return static_cast<double>(grid.width()) * grid.height();
  };
  GazeFollower follower({.base_radius = base});
  std::size_t seen = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    follower.add({samples[i].gaze}, ClientTime{units::from_s(1.0 + samples[i].t_s)});
    bool jumped = false;
    for (seen = i + 1; seen < samples.size(); ++seen) {
      const double passed_s = samples[seen].t_s - samples[seen - 1].t_s;
      jumped |= degrees(samples[seen].gaze, samples[seen - 1].gaze) > 100.0 * passed_s;
      if (samples[seen].t_s >= samples[i].t_s + 0.060) break;
    }
    if (jumped || seen >= samples.size() || follower.phase() == GazePhase::Saccade) continue;
    const FollowedGaze followed = follower.follow(60ms);
    const double off = degrees(samples[seen].gaze, followed.centre.direction);
    misses.frames += 1.0;
    misses.fixed += off > base.value() ? 1.0 : 0.0;
    misses.grown += off > followed.radius.value() ? 1.0 : 0.0;
    if (i % 97 != 0) continue;
    misses.fixed_cells += cells(followed, base);
    misses.grown_cells += cells(followed, followed.radius);
  }
}

// Cells stand for bytes here; GazeBytes weighs them.
TEST(GazeFollower, OnRecordedGazesTheGrownDiscIsLeftAThirdAsOftenForAThirdMoreCells) {
  MACULA_NEEDS_HANDED_DATA("traces");
  for (const double base : {2.0, 3.0, 5.0}) {
    Misses misses;
    for (const auto& file : test::recorded_gazes())
      count_misses(test::load_gazes(file), Degrees{base}, misses);
    std::printf("base %.0f deg: %.0f frames, outside %.3f %% fixed, %.3f %% grown; cells x %.3f\n",
                base, misses.frames, 100.0 * misses.fixed / misses.frames,
                100.0 * misses.grown / misses.frames, misses.grown_cells / misses.fixed_cells);
    EXPECT_GE(misses.frames, 10'000.0);
    EXPECT_LE(3.0 * misses.grown, misses.fixed);
    EXPECT_LE(misses.grown_cells, 1.3 * misses.fixed_cells);
  }
}

}  // namespace
}  // namespace macula::foveation
