#include "tests/bench/lightcuts_gains.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace macula::bench {
namespace {

/// Errors fall as 1 / samples, outside to twice of them; time grows with samples.
Judged point(const std::string& name, int samples) {
  return {name, name, 100.0 * samples, 0.08 / samples, 0.16 / samples};
}
std::vector<Judged> curve(const std::string& name, int most) {
  std::vector<Judged> points;
  for (int samples = 1; samples <= most; samples *= 2) points.push_back(point(name, samples));
  return points;
}

// At 300 ms the curve errs by .08 / 3, and it errs by .005 at 16 samples, 1600 ms.
TEST(LightcutsGains, AreReadBetweenTwoPointsOfAFallingCurve) {
  std::vector<Judged> all = curve("sl", 32);
  all.push_back({"paper", "sl", 300.0, 0.005, 0.02});
  const LightcutsGains gains = gains_of(all.back(), all);
  EXPECT_NEAR(gains.gain_f25, 0.08 / 3.0 / 0.005, 1e-9);
  EXPECT_NEAR(gains.gain_out25, 0.16 / 3.0 / 0.02, 1e-9);
  EXPECT_NEAR(gains.speed_f25, 1600.0 / 300.0, 1e-9);
  EXPECT_EQ(gains.plain_gain_f25, gains.gain_f25);
  EXPECT_EQ(gains.not_read, 0);
}

TEST(LightcutsGains, AreNoNumbersBeyondTheCurveAndCounted) {
  std::vector<Judged> all = curve("sl", 8);
  all.push_back({"paper", "sl", 300.0, 0.005, 0.02});  // .01 is the least that sl errs by
  const LightcutsGains gains = gains_of(all.back(), all);
  EXPECT_TRUE(std::isnan(gains.speed_f25));
  EXPECT_FALSE(std::isnan(gains.gain_f25));
  EXPECT_EQ(gains.not_read, 1);
  all.back().cpu_ms = 900.0;
  EXPECT_EQ(gains_of(all.back(), all).not_read, 5);
}

TEST(LightcutsGains, ABaselineThatWasNotMeasuredIsNotCountedAsBeyond) {
  std::vector<Judged> all = curve("sl", 8);
  all.push_back({"ours", "sl_denoised", 300.0, 0.02, 0.02});
  const LightcutsGains gains = gains_of(all.back(), all);
  EXPECT_TRUE(std::isnan(gains.gain_f25));
  EXPECT_NEAR(gains.plain_gain_f25, 0.08 / 3.0 / 0.02, 1e-9);
  EXPECT_EQ(gains.not_read, 0);
}

TEST(LightcutsGains, ACurveReachesAllAtTheFirstPointThatIsLongerAndBetterThanEveryMethod) {
  std::vector<Judged> all{{"paper", "sl", 300.0, 0.005, 0.02}};
  int samples = 1;
  for (; !reaches_all("sl", all); samples *= 2) all.push_back(point("sl", samples));
  EXPECT_EQ(samples, 32) << "16 samples err as little as the method";
  EXPECT_EQ(gains_of(all.front(), all).not_read, 0);
}

// Smoothed, eight samples err less than sixteen. At 1200 ms the baseline takes the eight, and it
// errs by .011 after 800 ms or a little less, not after the 1600 ms or more of the other branch.
TEST(LightcutsGains, ABaselineThatErrsMoreWithMoreSamplesTakesFewer) {
  std::vector<Judged> all{{"sl", "sl", 400.0, 0.04, 0.04},
                          {"sl", "sl", 800.0, 0.01, 0.01},
                          {"sl", "sl", 1600.0, 0.02, 0.02},
                          {"sl", "sl", 3200.0, 0.005, 0.005},
                          {"ours", "sl", 1200.0, 0.02, 0.005}};
  const LightcutsGains gains = gains_of(all.back(), all);
  EXPECT_NEAR(gains.gain_out25, 0.01 / 0.005, 1e-9);
  // From 400 to 800 ms errors fall fourfold: half of that is a root of two in time.
  EXPECT_NEAR(gains.speed_f25, 400.0 * std::sqrt(2.0) / 1200.0, 1e-9);
}

// ours has its own baseline, and is told against sl at equal time as well.
TEST(LightcutsGains, ThePlainCurveReachesTheTimesOfAllMethodsAndTheErrorsOfItsOwn) {
  std::vector<Judged> all{{"paper", "sl", 300.0, 0.02, 0.02},
                          {"ours", "sl_denoised", 700.0, 0.0001, 0.02}};
  for (const Judged& one : curve("sl", 4)) all.push_back(one);
  EXPECT_FALSE(reaches_all("sl", all)) << "400 of 700 ms";
  all.push_back(point("sl", 8));
  EXPECT_TRUE(reaches_all("sl", all));
  EXPECT_FALSE(reaches_all("sl_denoised", all)) << "none of it is measured";
}

TEST(LightcutsGains, ACurveThatNothingIsReadOffIsMeasuredWhole) {
  EXPECT_FALSE(reaches_all("sl", curve("sl", 64)));
}

}  // namespace
}  // namespace macula::bench
