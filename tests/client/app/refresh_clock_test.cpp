#include "client/app/refresh_clock.h"

#include <gtest/gtest.h>

namespace macula::client_app {
namespace {

// The hands are turned to or past every boundary before the clock is asked, so it never sleeps.
TEST(RefreshClock, GoesByThePeriodInRealTime) {
  base::ManualClock clock;
  RefreshClock refreshes(clock, 100.0, Pacing::RealTime);
  const Refresh first = refreshes.next();
  EXPECT_EQ(first.index, 0U);
  EXPECT_EQ(first.display - first.begin, units::from_ms(10.0));
  clock.advance(units::from_ms(10.5));
  const Refresh second = refreshes.next();
  EXPECT_EQ(second.index, 1U);
  EXPECT_EQ(second.begin, ClientTime{units::from_ms(10.5)});
  EXPECT_EQ(second.display, ClientTime{units::from_ms(20.0)});
  EXPECT_EQ(second.pose_time, second.begin);
  EXPECT_EQ(refreshes.missed(), 0U);
}

TEST(RefreshClock, MissesWhatIsOverBeforeItCouldBegin) {
  base::ManualClock clock;
  RefreshClock refreshes(clock, 100.0, Pacing::RealTime);
  refreshes.next();
  clock.advance(units::from_ms(45.0));
  EXPECT_EQ(refreshes.next().index, 4U);
  EXPECT_EQ(refreshes.missed(), 3U);
}

TEST(RefreshClock, StepsPoseTimeByOnePeriodWhenAsFastAsPossible) {
  base::ManualClock clock;
  RefreshClock refreshes(clock, 50.0, Pacing::AsFastAsPossible);
  for (int i = 0; i < 5; ++i) {
    const Refresh refresh = refreshes.next();
    EXPECT_EQ(refresh.pose_time, ClientTime{i * units::from_ms(20.0)});
    EXPECT_EQ(refresh.begin, ClientTime{clock.now()});
    refreshes.wait_for_display(refresh);
    clock.advance(units::from_ms(i * 7.0));
  }
  EXPECT_EQ(refreshes.missed(), 0U);
}

}  // namespace
}  // namespace macula::client_app
