#include "server/session/quality_ladder.h"

#include <gtest/gtest.h>

namespace macula::session {
namespace {

const kernels::KnobValues kOne{{"samples", "1"}}, kFour{{"samples", "4"}};

std::vector<QualityStep> three_steps() {
  return {{0.0, 0.25, kOne, 0.04, 0.1}, {4.0, 1.0, kOne, 0.2, 0.05}, {10.0, 1.0, kFour, 1.0, 0.02}};
}

TEST(QualityLadder, AStepsOwnQualityIsTheStep) {
  const auto ladder = QualityLadder::create(three_steps());
  ASSERT_TRUE(ladder);
  for (std::size_t i = 0; i < 3; ++i) {
    const QualityStep& step = ladder->steps()[i];
    const QualityPoint point = ladder->at(step.quality);
    EXPECT_EQ(point.step, i);
    EXPECT_EQ(point.scale, step.scale);
    EXPECT_EQ(point.cost, step.cost);
    EXPECT_EQ(point.rmse, step.rmse);
  }
}

// Half way between 0.25 and 1 in the logarithm is 0.5.
TEST(QualityLadder, BetweenStepsOfTheSameKnobsTheScaleIsCarriedOn) {
  const QualityPoint point = QualityLadder::create(three_steps())->at(2.0);
  EXPECT_EQ(point.step, 1U);
  EXPECT_NEAR(point.scale, 0.5, 1e-12);
}

TEST(QualityLadder, CostRisesAndErrorFallsAllTheWay) {
  const auto ladder = QualityLadder::create(three_steps());
  for (double quality = 0.1; quality <= 10.0; quality += 0.1) {
    const QualityPoint below = ladder->at(quality - 0.1), here = ladder->at(quality);
    EXPECT_GT(here.cost, below.cost);
    EXPECT_LT(here.rmse, below.rmse);
    EXPECT_GT(here.scale, 0.0);
    EXPECT_LE(here.scale, 1.0);
  }
}

TEST(QualityLadder, FindsTheLeastQualityOfAnError) {
  const auto ladder = QualityLadder::create(three_steps());
  const double quality = ladder->quality_for_error(0.05);
  EXPECT_NEAR(quality, 4.0, 0.11);
  EXPECT_LE(ladder->at(quality).rmse, 0.05);
  EXPECT_EQ(ladder->quality_for_error(1e-9), kBestQuality);
}

TEST(QualityLadder, StepsThatContradictAreRefused) {
  const auto refused = [](auto&& change) {
    std::vector<QualityStep> steps = three_steps();
    change(steps);
    return !QualityLadder::create(std::move(steps));
  };
  EXPECT_FALSE(refused([](auto&) {}));
  EXPECT_TRUE(refused([](auto& s) { s.resize(1); }));
  EXPECT_TRUE(refused([](auto& s) { s[1].cost = 0.01; }));
  EXPECT_TRUE(refused([](auto& s) { s[1].rmse = 0.2; }));
  EXPECT_TRUE(refused([](auto& s) { s[1].quality = 11.0; }));
  EXPECT_TRUE(refused([](auto& s) { s[2].quality = 9.0; }));
  EXPECT_TRUE(refused([](auto& s) { s[0].scale = 0.0; }));
}

}  // namespace
}  // namespace macula::session
