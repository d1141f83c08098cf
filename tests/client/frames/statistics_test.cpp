#include "client/frames/statistics.h"

#include <gtest/gtest.h>

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
