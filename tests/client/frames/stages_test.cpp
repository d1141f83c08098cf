#include "client/frames/stages.h"

#include <gtest/gtest.h>

#include "tests/client/frames/stamped_path.h"

namespace macula::frames {
namespace {

using test::StampedPath;

constexpr net::ClockEstimate kExact{StampedPath::kOffset, Nanoseconds{0}, Nanoseconds{0}};

TEST(Stages, AddUpToTheTotal) {
  const StampedPath path;
  const StageTimes times = account(path.server(), path.client(), kExact);
  for (std::size_t i = 0; i < kStageCount; ++i) EXPECT_EQ(times.stages[i], path.durations[i]);
  EXPECT_EQ(times.sum(), times.total);
  EXPECT_EQ(times.unattributed, Nanoseconds{0});
  EXPECT_EQ(times.total, path.total());
}

TEST(Stages, ShowThirtyMillisecondsWhereTheyWereSpentAndNowhereElse) {
  for (std::size_t injected = 0; injected < kStageCount; ++injected) {
    StampedPath path;
    const auto before = path.durations;
    path.durations[injected] += units::from_ms(30.0);
    const StageTimes times = account(path.server(), path.client(), kExact);
    for (std::size_t i = 0; i < kStageCount; ++i) {
      EXPECT_NEAR(units::to_ms(times.stages[i] - before[i]), i == injected ? 30.0 : 0.0, 1.0)
          << "injected into " << name(static_cast<Stage>(injected)) << ", seen in "
          << name(static_cast<Stage>(i));
    }
    EXPECT_EQ(times.sum(), times.total);
  }
}

// The wait before the display is two parts of one stage: before the warp and after it.
TEST(Stages, CountBothPartsOfThePresentWait) {
  for (const double before_warp_share : {0.0, 0.25, 1.0}) {
    StampedPath path;
    path.before_warp_share = before_warp_share;
    const StageTimes times = account(path.server(), path.client(), kExact);
    EXPECT_EQ(times[Stage::PresentWait], units::from_ms(6.0));
    EXPECT_EQ(times.unattributed, Nanoseconds{0});
  }
}

// An estimate off by d moves d from the downlink to the uplink (or back); the sum does not notice.
TEST(Stages, PutAClockErrorIntoUplinkAndDownlinkOnly) {
  const StampedPath path;
  for (const double error_ms : {-0.4, 0.4}) {
    net::ClockEstimate skewed = kExact;
    skewed.server_minus_client += units::from_ms(error_ms);
    const StageTimes times = account(path.server(), path.client(), skewed);
    EXPECT_NEAR(units::to_ms(times[Stage::Uplink]), 2.0 - error_ms, 1e-6);
    EXPECT_NEAR(units::to_ms(times[Stage::Downlink]), 4.0 + error_ms, 1e-6);
    EXPECT_EQ(times[Stage::Render], units::from_ms(20.0));
    EXPECT_EQ(times.sum() + times.unattributed, times.total);
  }
}

TEST(Stages, MayMakeTheUplinkNegativeByTheClockErrorButStillAddUp) {
  const StampedPath path;
  net::ClockEstimate skewed = kExact;
  skewed.server_minus_client += units::from_ms(2.5);
  const StageTimes times = account(path.server(), path.client(), skewed);
  EXPECT_NEAR(units::to_ms(times[Stage::Uplink]), -0.5, 1e-6);
  EXPECT_EQ(times.sum() + times.unattributed, times.total);
}

TEST(Stages, ReportAGapNoStageCovers) {
  StampedPath path;
  path.gap_before_encode = units::from_ms(5.0);
  const StageTimes times = account(path.server(), path.client(), kExact);
  EXPECT_EQ(times.unattributed, units::from_ms(5.0));
  EXPECT_EQ(times[Stage::Encode], units::from_ms(3.0));
  EXPECT_EQ(times.sum() + times.unattributed, times.total);
}

// Encoding may start on the first slice while later ones are still rendered: the overlap counts
// once.
TEST(Stages, CountAnOverlapOnce) {
  StampedPath path;
  path.gap_before_encode = units::from_ms(-2.0);
  const StageTimes times = account(path.server(), path.client(), kExact);
  EXPECT_EQ(times[Stage::Render], units::from_ms(20.0));
  EXPECT_EQ(times[Stage::Encode], units::from_ms(1.0));
  EXPECT_EQ(times.unattributed, Nanoseconds{0});
  EXPECT_EQ(times.sum(), times.total);
}

TEST(Stages, HaveTheNamesOfTheReport) {
  EXPECT_STREQ(name(Stage::Uplink), "uplink");
  EXPECT_STREQ(name(Stage::ViewWait), "view_wait");
  EXPECT_STREQ(name(Stage::PresentWait), "present_wait");
}

}  // namespace
}  // namespace macula::frames
