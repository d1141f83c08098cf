#include "client/frames/statistics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace macula::frames {
namespace {

// Of 1..101 the quantile q is 1 + 100 q.
TEST(Series, KnowsItsQuantiles) {
  Series series;
  for (int i = 101; i >= 1; --i) series.add(i);
  EXPECT_DOUBLE_EQ(series.quantile(0.0), 1.0);
  EXPECT_DOUBLE_EQ(series.quantile(0.5), 51.0);
  EXPECT_DOUBLE_EQ(series.quantile(0.95), 96.0);
  EXPECT_DOUBLE_EQ(series.largest(), 101.0);
  EXPECT_DOUBLE_EQ(series.mean(), 51.0);
}

TEST(Series, InterpolatesBetweenNeighbours) {
  Series series;
  series.add(10.0);
  series.add(20.0);
  EXPECT_DOUBLE_EQ(series.quantile(0.95), 19.5);
}

TEST(Series, IsZeroWhenEmpty) {
  EXPECT_EQ(Series{}.quantile(0.5), 0.0);
  EXPECT_EQ(Series{}.mean(), 0.0);
}

/// Rank and value agree here: 0..n-1 in an order without pattern.
TEST(Series, KeepsQuantilesOfALongRunInBoundedMemory) {
  constexpr std::uint64_t kValues = 1'000'003;  // a prime
  Series series;
  for (std::uint64_t i = 0; i < kValues; ++i)
    series.add(static_cast<double>(i * 611'953 % kValues));
  EXPECT_EQ(series.count(), kValues);
  EXPECT_NEAR(series.mean(), 0.5 * (kValues - 1), 1e-3);
  EXPECT_EQ(series.quantile(0.0), 0.0);
  EXPECT_EQ(series.largest(), kValues - 1.0);
  for (const double q : {0.05, 0.5, 0.95}) {
    const double rank_error = std::sqrt(q * (1.0 - q) / Series::kMost);
    EXPECT_NEAR(series.quantile(q) / kValues, q, 4.0 * rank_error) << q;
  }
}

/// The twin: had only the newest been kept, a run that gets slower would look slow throughout.
TEST(Series, SpeaksOfTheWholeRunAndNotOfItsEnd) {
  Series series;
  const int values = 3 * static_cast<int>(Series::kMost);
  for (int i = 0; i < values; ++i) series.add(i);
  EXPECT_NEAR(series.quantile(0.5), 0.5 * values, 0.02 * values);
}

TEST(Ages, CountFromTheSamplesBehindTheFrame) {
  net::FrameBegin begin;
  begin.view_sampled = ClientTime{units::from_ms(100.0)};
  begin.gaze_sampled = ClientTime{units::from_ms(95.0)};
  Ages ages;
  ages.add(ClientTime{units::from_ms(160.0)}, begin);
  EXPECT_DOUBLE_EQ(ages.pose_ms.quantile(0.5), 60.0);
  EXPECT_DOUBLE_EQ(ages.gaze_ms.quantile(0.5), 65.0);
}

}  // namespace
}  // namespace macula::frames
