#include "client/app/late_start.h"

#include <gtest/gtest.h>

namespace macula::client_app {
namespace {

using namespace std::chrono_literals;

TEST(LateStart, BeginsAWholePeriodBeforeTheLightUntilAWarpIsKnown) {
  LateStart start(14ms);
  EXPECT_EQ(start.lead(), 14ms);
  start.note(4ms, 0ms);
  EXPECT_EQ(start.lead(), 7ms) << "4 ms, a quarter more, and 2 ms";
}

TEST(LateStart, NeverAsksForMoreThanAPeriod) {
  LateStart start(14ms);
  start.note(40ms, 0ms);
  EXPECT_EQ(start.lead(), 14ms);
}

TEST(LateStart, ALongWarpCountsAtOnceAndIsForgottenSlowly) {
  LateStart start(14ms);
  start.note(2ms, 0ms);
  start.note(8ms, 0ms);
  EXPECT_EQ(start.lead(), 12ms);
  for (int i = 0; i < 35; ++i) start.note(2ms, 0ms);
  EXPECT_LT(start.lead(), 7100us);
  EXPECT_GT(start.lead(), 6500us);
  for (int i = 0; i < 200; ++i) start.note(2ms, 0ms);
  EXPECT_EQ(start.lead(), 4500us);
}

TEST(LateStart, EveryMissedLightWidensTheMarginForAThousandRefreshes) {
  LateStart start(14ms);
  start.note(2ms, 3ms);
  EXPECT_EQ(start.lead(), 4500us) << "a little late is how clocks wake";
  start.note(2ms, 14ms);
  EXPECT_EQ(start.lead(), 6500us);
  for (int i = 0; i < 100; ++i) start.note(2ms, 0ms);
  EXPECT_GT(start.lead(), 6200us) << "or the light would be missed again at once";
  for (int i = 0; i < 5000; ++i) start.note(2ms, 0ms);
  EXPECT_LT(start.lead(), 4600us);
  for (int i = 0; i < 20; ++i) start.note(2ms, 14ms);
  EXPECT_EQ(start.lead(), 14ms);
}

}  // namespace
}  // namespace macula::client_app
