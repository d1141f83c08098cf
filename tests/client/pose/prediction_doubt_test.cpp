#include "client/pose/prediction_doubt.h"

#include <gtest/gtest.h>

namespace macula::pose {
namespace {

ClientTime at_ms(double ms) {
  return ClientTime{units::from_ms(ms)};
}
/// A head that walks a meter a second to the right.
HeadSample walking(double ms) {
  HeadSample sample;
  sample.at = at_ms(ms);
  sample.stage_from_head.position = {1e-3 * ms, 1.6, 0.0};
  return sample;
}

TEST(PredictionDoubt, IsHowFarForetoldPosesWereOff) {
  PredictionDoubt doubt;
  doubt.add(walking(0));
  Pose off = walking(15).stage_from_head;
  off.position.y += 0.02;
  off.rotation = glm::angleAxis(0.1, DVec3{0, 1, 0});
  doubt.foretold(at_ms(15), off);
  EXPECT_EQ(doubt.position_m(), 0.0) << "it has not come to pass";
  doubt.add(walking(10));
  EXPECT_EQ(doubt.position_m(), 0.0);
  doubt.add(walking(20));
  EXPECT_NEAR(doubt.position_m(), 0.02, 1e-12);
  EXPECT_NEAR(doubt.turn().value(), 0.1, 1e-9);
}

TEST(PredictionDoubt, IsNoneWhereTheHeadDidAsForetold) {
  PredictionDoubt doubt;
  for (double ms = 0; ms < 500; ms += 11) {
    doubt.add(walking(ms));
    doubt.foretold(at_ms(ms + 16), walking(ms + 16).stage_from_head);
  }
  EXPECT_LT(doubt.position_m(), 1e-9);
}

TEST(PredictionDoubt, ForgetsAfterASecond) {
  PredictionDoubt doubt;
  doubt.add(walking(0));
  doubt.foretold(at_ms(5), Pose{});
  doubt.add(walking(10));
  EXPECT_GT(doubt.position_m(), 1.0);
  doubt.add(walking(900));
  EXPECT_GT(doubt.position_m(), 1.0);
  doubt.add(walking(1100));
  EXPECT_EQ(doubt.position_m(), 0.0);
}

TEST(PredictionDoubt, StartsAnewWhenTimeDoes) {
  PredictionDoubt doubt;
  doubt.add(walking(1000));
  doubt.foretold(at_ms(1005), Pose{});
  doubt.add(walking(0));
  doubt.foretold(at_ms(5), walking(5).stage_from_head);
  doubt.add(walking(10));
  EXPECT_LT(doubt.position_m(), 1e-9);
}

}  // namespace
}  // namespace macula::pose
