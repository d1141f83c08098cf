#include "client/pose/saccades.h"

#include <gtest/gtest.h>

namespace macula::pose {
namespace {

HeadSample looking(double ms, double yaw_deg) {
  const double yaw = Radians{Degrees{yaw_deg}}.value();
  HeadSample sample;
  sample.gaze_at = ClientTime{units::from_ms(ms)};
  sample.gaze.direction = Vec3(DVec3{std::sin(yaw), 0.0, -std::cos(yaw)});
  return sample;
}

/// Yaw as a function of time in ms, sampled every 10 ms for 2 s.
template <class Yaw>
std::uint64_t count(Yaw yaw_deg) {
  SaccadeCounter counter;
  for (double ms = 0.0; ms < 2000.0; ms += 10.0) counter.add(looking(ms, yaw_deg(ms)));
  return counter.count();
}

TEST(SaccadeCounter, CountsALargeSaccadeOnce) {
  // 40 degrees in 60 ms, one way and back again a second later.
  EXPECT_EQ(count([](double ms) {
              const double there = std::clamp((ms - 500.0) / 60.0, 0.0, 1.0);
              const double back = std::clamp((ms - 1500.0) / 60.0, 0.0, 1.0);
              return 40.0 * (there - back);
            }),
            2U);
}

TEST(SaccadeCounter, LeavesSmallOnesAndSlowDriftOut) {
  EXPECT_EQ(count([](double ms) { return ms < 1000.0 ? 0.0 : 9.5; }), 0U);
  EXPECT_EQ(count([](double ms) { return 0.05 * ms; }), 0U);  // 50 deg/s pursuit
}

// A display that refreshes five times a second never sees the saccade itself.
TEST(SaccadeCounter, SeesAJumpBetweenSamplesThatLieFarApart) {
  SaccadeCounter counter;
  for (const double ms : {0.0, 200.0, 400.0, 600.0}) {
    counter.add(looking(ms, ms < 300.0 ? 0.0 : 15.0));
  }
  EXPECT_EQ(counter.count(), 1U);
}

TEST(SaccadeCounter, PassesOverInvalidGaze) {
  SaccadeCounter counter;
  counter.add(looking(0.0, 0.0));
  HeadSample blink = looking(10.0, 60.0);
  blink.gaze.valid = false;
  counter.add(blink);
  counter.add(looking(20.0, 0.0));
  EXPECT_EQ(counter.count(), 0U);
}

}  // namespace
}  // namespace macula::pose
