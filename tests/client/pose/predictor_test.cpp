#include "client/pose/predictor.h"

#include <gtest/gtest.h>

namespace macula::pose {
namespace {

constexpr ClientTime kStart{units::from_s(10.0)};

ClientTime at_ms(double ms) {
  return kStart + units::from_ms(ms);
}

/// A head that turns about a tilted axis and moves, both at constant speed.
HeadSample moving(double ms, Degrees turn_per_s, double speed_m_per_s) {
  const DVec3 axis = glm::normalize(DVec3{0.2, 1.0, -0.3});
  const DQuat first = glm::angleAxis(0.7, glm::normalize(DVec3{1.0, 0.5, 0.25}));
  const double s = 1e-3 * ms;
  const DQuat turn = glm::angleAxis(Radians{turn_per_s}.value() * s, axis);
  HeadSample sample;
  sample.at = at_ms(ms);
  sample.stage_from_head = {DVec3{0.0, 1.6, 0.0} + DVec3{speed_m_per_s * s, 0.0, 0.0},
                            turn * first};
  return sample;
}

Predictor fed(Degrees turn_per_s, double speed_m_per_s) {
  Predictor predictor;
  for (const double ms : {0.0, 14.0, 28.0, 42.0}) {
    predictor.add(moving(ms, turn_per_s, speed_m_per_s));
  }
  return predictor;
}

TEST(Predictor, IsExactOnConstantVelocity) {
  const Predictor predictor = fed(Degrees{90.0}, 0.4);
  for (const double horizon_ms : {0.0, 5.0, 14.0, 50.0, 100.0}) {
    const Pose truth = moving(42.0 + horizon_ms, Degrees{90.0}, 0.4).stage_from_head;
    const Pose guess = predictor.predict(at_ms(42.0 + horizon_ms));
    EXPECT_LT(math::angle_between(truth, guess).value(), 1e-9);
    EXPECT_LT(glm::length(truth.position - guess.position), 1e-9);
  }
}

TEST(Predictor, LooksNoFurtherThanAHundredMilliseconds) {
  const Predictor predictor = fed(Degrees{90.0}, 0.4);
  const Pose far = predictor.predict(at_ms(42.0 + 500.0));
  const Pose limit = moving(142.0, Degrees{90.0}, 0.4).stage_from_head;
  EXPECT_LT(math::angle_between(far, limit).value(), 1e-9);
  EXPECT_LT(glm::length(far.position - limit.position), 1e-9);
}

TEST(Predictor, TurnsNoFasterThanTwoHundredDegreesASecond) {
  const Predictor predictor = fed(Degrees{500.0}, 0.0);
  const Pose now = predictor.predict(at_ms(42.0));
  const Pose next = predictor.predict(at_ms(92.0));
  EXPECT_NEAR(Degrees{math::angle_between(now, next)}.value(), 10.0, 1e-6);
}

TEST(Predictor, MovesNoFasterThanThreeMetersASecond) {
  const Predictor predictor = fed(Degrees{0.0}, 50.0);
  const Pose now = predictor.predict(at_ms(42.0));
  const Pose next = predictor.predict(at_ms(52.0));
  EXPECT_NEAR(glm::length(next.position - now.position), 0.03, 1e-9);
}

TEST(Predictor, KeepsTheNewestPoseForThePastAndForOneSample) {
  Predictor predictor;
  predictor.add(moving(0.0, Degrees{90.0}, 1.0));
  EXPECT_EQ(predictor.predict(at_ms(50.0)).position, DVec3(0.0, 1.6, 0.0));
  predictor.add(moving(14.0, Degrees{90.0}, 1.0));
  EXPECT_EQ(predictor.predict(at_ms(0.0)).position.x,
            moving(14.0, Degrees{90.0}, 1.0).stage_from_head.position.x);
}

TEST(Predictor, StartsAfreshWhenTimeStepsBack) {
  Predictor predictor = fed(Degrees{90.0}, 1.0);
  predictor.add(moving(0.0, Degrees{0.0}, 0.0));
  EXPECT_EQ(predictor.predict(at_ms(50.0)).position, DVec3(0.0, 1.6, 0.0));
}

// q and -q are the same orientation: a tracker may switch between them at any sample.
TEST(Predictor, TakesTheShorterArcBetweenOppositeSigns) {
  Predictor predictor;
  predictor.add(moving(0.0, Degrees{90.0}, 0.0));
  HeadSample flipped = moving(14.0, Degrees{90.0}, 0.0);
  flipped.stage_from_head.rotation = -flipped.stage_from_head.rotation;
  predictor.add(flipped);
  const Pose truth = moving(28.0, Degrees{90.0}, 0.0).stage_from_head;
  EXPECT_LT(math::angle_between(truth, predictor.predict(at_ms(28.0))).value(), 1e-9);
}

}  // namespace
}  // namespace macula::pose
