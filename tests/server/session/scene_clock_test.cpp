#include "server/session/scene_clock.h"

#include <gtest/gtest.h>

namespace macula::session {
namespace {

using namespace std::chrono_literals;

TEST(SceneClock, CountsWholeTicksFromTheStart) {
  const ServerTime start{123'456'789ns};
  const SceneClock clock(start);
  EXPECT_EQ(clock.at(start).since_start, 0ns);
  EXPECT_EQ(clock.at(start + SceneClock::kTick - 1ns).since_start, 0ns);
  EXPECT_EQ(clock.at(start + SceneClock::kTick).since_start, SceneClock::kTick);
  EXPECT_EQ(clock.at(start + 24h + 1ns).since_start, 24h);
}

TEST(SceneClock, SessionsThatBeginInOneTickSeeOneMoment) {
  const ServerTime start{0ns};
  const SceneClock clock(start);
  EXPECT_EQ(clock.at(start + 1001ms), clock.at(start + 1003ms));
  EXPECT_LT(clock.at(start + 1003ms), clock.at(start + 1004ms));
}

TEST(SceneClock, NeverShowsATimeBeforeTheStart) {
  EXPECT_EQ(SceneClock(ServerTime{5s}).at(ServerTime{4s}).since_start, 0ns);
}

}  // namespace
}  // namespace macula::session
