#include "server/sdf/march.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace macula::sdf {
namespace {

class March : public testing::TestWithParam<Stepping> {
 protected:
  /// Lanes along -z that ask at 1 m.
  void SetUp() override {
    for (std::size_t i = 0; i < 16; ++i) {
      lanes.z[i] = -1.0F;
      lanes.at[i] = lanes.t[i] = 1.0F;
      lanes.slope[i] = -1.0F;
      lanes.width[i] = 1e-3F;
    }
    limits.slab_high = 50.0F;
    limits.far_m = 100.0F;
    limits.max_steps = 10;
  }
  std::size_t step() { return advance(GetParam(), lanes, 16, found, limits, points); }
  LaneState state(std::size_t i) const { return static_cast<LaneState>(lanes.state[i]); }

  Chunk lanes{};
  DistanceBatch found{};
  PointBatch points{};
  MarchLimits limits;
};

TEST_P(March, EndsALaneWhereTheFieldIsNoNumberAndLeavesTheOthers) {
  for (float& distance : found.at) distance = 0.5F;
  found.at[3] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(step(), 15U);
  EXPECT_EQ(state(3), LaneState::Broken);
  EXPECT_EQ(lanes.at[3], 1.0F);
  EXPECT_EQ(state(4), LaneState::Live);
  EXPECT_NEAR(lanes.at[4], 1.5F, 2e-3F);  // less the hit distance
  EXPECT_EQ(points.z[4], -lanes.at[4]);
}

TEST_P(March, EndsLanesAtTheEndOfTheWorldAndAfterTheirLastStep) {
  for (float& distance : found.at) distance = 0.5F;
  found.at[0] = std::numeric_limits<float>::infinity();
  lanes.steps[1] = limits.max_steps - 1;
  step();
  EXPECT_EQ(state(0), LaneState::Miss);
  EXPECT_EQ(state(1), LaneState::Capped);
}

TEST_P(March, LetsLanesLeaveTheirSlab) {
  for (float& distance : found.at) distance = 0.5F;
  limits.slab_high = 1.2F;
  EXPECT_EQ(step(), 0U);
  EXPECT_EQ(state(7), LaneState::Left);
}

TEST_P(March, GivesALaneTheSameBitsAtEveryPlace) {
  for (float& distance : found.at) distance = 0.37F;
  step();
  for (std::size_t i = 1; i < 16; ++i) ASSERT_EQ(lanes.at[i], lanes.at[0]);
}

INSTANTIATE_TEST_SUITE_P(Sdf, March,
                         testing::Values(Stepping::Plain, Stepping::Relaxed, Stepping::Cone));

TEST(RelaxedSteps, GoBackWhereTheBallsDoNotTouch) {
  Chunk lanes{};
  DistanceBatch found{};
  PointBatch points{};
  lanes.t[0] = 1.0F;
  lanes.radius[0] = 0.5F;
  lanes.at[0] = 1.9F;  // 0.9 beyond t, but the balls of 0.5 and 0.2 reach only 0.7 far
  lanes.slope[0] = 0.2F;
  found.at[0] = 0.2F;
  MarchLimits limits;
  limits.slab_high = 50.0F, limits.far_m = 100.0F, limits.hit_m = 1e-4F, limits.max_steps = 10;
  advance(Stepping::Relaxed, lanes, 1, found, limits, points);
  EXPECT_EQ(static_cast<LaneState>(lanes.state[0]), LaneState::Live);
  EXPECT_EQ(lanes.at[0], lanes.first[0]);  // the first mark beyond what is clear
  EXPECT_GT(lanes.at[0], 1.5F);
  EXPECT_LE(lanes.at[0], 1.5F + 2e-4F);
  EXPECT_FLOAT_EQ(lanes.t[0], 1.0F);
}

}  // namespace
}  // namespace macula::sdf
