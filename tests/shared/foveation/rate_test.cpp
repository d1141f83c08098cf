#include "shared/foveation/rate.h"

#include <gtest/gtest.h>

namespace macula::foveation {
namespace {

double rate_at(std::string_view preset, double degrees) {
  return find_rate_model(preset).value().rate(Degrees{degrees});
}

TEST(RateModel, NeverRisesWithEccentricityAndStaysInZeroOne) {
  for (const RatePreset& preset : rate_presets()) {
    double previous = 1.0;
    for (double degrees = 0.0; degrees <= 180.0; degrees += 0.01) {
      const double rate = preset.model.rate(Degrees{degrees});
      ASSERT_GT(rate, 0.0) << preset.name << " at " << degrees;
      ASSERT_LE(rate, previous) << preset.name << " at " << degrees;
      previous = rate;
    }
  }
}

TEST(RateModel, LightcutsIsOneToFourDegreesAndReachesItsFloorAtTwentySeven) {
  EXPECT_EQ(rate_at("lightcuts", 4.01), 1.0);
  EXPECT_LT(rate_at("lightcuts", 4.02), 1.0);
  EXPECT_GT(rate_at("lightcuts", 26.92), 0.02);
  EXPECT_EQ(rate_at("lightcuts", 26.94), 0.02);
}

TEST(RateModel, RayRampHasExactEnds) {
  EXPECT_EQ(rate_at("ray-medium", 10.0), 1.0);
  EXPECT_NEAR(rate_at("ray-medium", 15.0), 0.525, 1e-12);
  EXPECT_EQ(rate_at("ray-medium", 20.0), 0.05);
  EXPECT_EQ(rate_at("ray-full", 100.0), 1.0);
}

TEST(RateModel, ARampOfZeroLengthIsAStep) {
  const RateModel step{RateCurve::Ray, Degrees{10.0}, Degrees{10.0}, 0.1};
  EXPECT_EQ(step.rate(Degrees{10.0}), 1.0);
  EXPECT_EQ(step.rate(Degrees{10.001}), 0.1);
}

TEST(RateModel, SphereFollowsTheCorrectedExponential) {
  // 0.90964 exp(-w / 2.9661) + 0.00792 at 10 and 15 degrees.
  EXPECT_NEAR(rate_at("sphere", 10.0), 0.0391, 1e-4);
  EXPECT_NEAR(rate_at("sphere", 15.0), 0.0137, 1e-4);
  EXPECT_EQ(rate_at("sphere", 7.5), 1.0);
}

TEST(RateModel, CorticalHalvesItsLinearDensityWhereMagnificationHalves) {
  // (3.67 / (e + 3.67))^0.6046 = 1/2 at e = 3.67 (2^(1/0.6046) - 1) = 7.878 degrees.
  EXPECT_NEAR(rate_at("cortical", 7.878), 0.25, 1e-3);
}

TEST(RateModel, AnUnknownNameAnswersWithTheKnownOnes) {
  const auto unknown = find_rate_model("ray-huge");
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.error().message().find("ray-medium"), std::string::npos);
}

}  // namespace
}  // namespace macula::foveation
