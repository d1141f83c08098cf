#include "client/pose/trace_source.h"

#include <gtest/gtest.h>

namespace macula::pose {
namespace {

Trace one_second() {
  Trace trace;
  trace.samples.push_back({units::from_s(5.0), Pose{}, std::nullopt});
  trace.samples.push_back({units::from_s(6.0), Pose{DVec3{1.0, 0.0, 0.0}}, std::nullopt});
  return trace;
}

constexpr ClientTime kStart{units::from_s(1000.0)};

TEST(TraceSource, StartsAtItsFirstCallAndEndsWithTheTrace) {
  TraceSource source(one_second());
  EXPECT_EQ(source.sample(kStart)->stage_from_head.position.x, 0.0);
  const auto later = source.sample(kStart + units::from_ms(250.0));
  ASSERT_TRUE(later);
  EXPECT_DOUBLE_EQ(later->stage_from_head.position.x, 0.25);
  EXPECT_EQ(later->at, kStart + units::from_ms(250.0));
  EXPECT_EQ(later->gaze_at, later->at);
  EXPECT_TRUE(source.sample(kStart + units::from_s(1.0)));
  EXPECT_FALSE(source.sample(kStart + units::from_s(1.001)));
}

TEST(TraceSource, StartsAgainWhenLooping) {
  TraceSource source(one_second(), AtEnd::Loop);
  source.sample(kStart);
  const auto again = source.sample(kStart + units::from_s(7.25));
  ASSERT_TRUE(again);
  EXPECT_NEAR(again->stage_from_head.position.x, 0.25, 1e-9);
}

}  // namespace
}  // namespace macula::pose
