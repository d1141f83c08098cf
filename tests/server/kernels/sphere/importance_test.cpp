#include "server/kernels/sphere/importance.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace macula::kernels::sphere {
namespace {

MaskConfig with(MaskRule rule, AcuityOrigin origin) {
  MaskConfig config;
  config.rule = rule;
  config.origin = origin;
  return config;
}

TEST(Importance, AcuityHasTheValuesOfItsEquation) {
  // 0.90964 exp(-w / 2.9661) + 0.00792 by hand.
  const std::vector<std::pair<double, double>> values{
      {0.0, 0.91756}, {2.5, 0.39950},  {5.0, 0.17650}, {6.0, 0.12824},
      {7.5, 0.08047}, {10.0, 0.03916}, {15.0, 0.01371}};
  for (const auto& [degrees, expected] : values)
    EXPECT_NEAR(acuity(Degrees{degrees}), expected, 1e-4) << degrees << " degrees";
}

TEST(Importance, EverythingInTheFoveaIsImportantAndNothingBeyondTheOuterZone) {
  const MaskConfig config;
  EXPECT_EQ(importance(Degrees{0.0}, 0.0F, config), 1.0);
  EXPECT_EQ(importance(config.fovea, 0.0F, config), 1.0);
  EXPECT_EQ(importance(Degrees{config.outer.value() + 1e-6}, 1.0F, config), 0.0);
}

TEST(Importance, NeverRisesWithEccentricityAndNeverFallsWithAnEdge) {
  for (const AcuityOrigin origin : {AcuityOrigin::Gaze, AcuityOrigin::FoveaRim}) {
    const MaskConfig config = with(MaskRule::Corrected, origin);
    double last = 1.0;
    for (double e = 0.0; e < 30.0; e += 0.25) {
      const double flat = importance(Degrees{e}, 0.0F, config);
      const double edge = importance(Degrees{e}, 1.0F, config);
      EXPECT_GE(edge, flat);
      EXPECT_LE(edge, last);
      last = edge;
    }
  }
}

TEST(Importance, StartingAtTheRimLeavesNoJumpForEdges) {
  const MaskConfig shifted = with(MaskRule::Corrected, AcuityOrigin::FoveaRim);
  const MaskConfig printed = with(MaskRule::Corrected, AcuityOrigin::Gaze);
  const Degrees beyond{shifted.fovea.value() + 1e-9};
  EXPECT_GT(importance(beyond, 1.0F, shifted), 0.9);
  EXPECT_LT(importance(beyond, 1.0F, printed), 0.1);
}

TEST(Importance, TheLiteralProductDropsTheFlatFovea) {
  const MaskConfig literal = with(MaskRule::Literal, AcuityOrigin::Gaze);
  EXPECT_EQ(importance(Degrees{1.0}, 0.0F, literal), 0.0);
  EXPECT_EQ(importance(Degrees{1.0}, 1.0F, literal), 1.0);
  EXPECT_NEAR(importance(Degrees{10.0}, 1.0F, literal), 0.03916, 1e-4);
}

TEST(Importance, ThresholdsSelectTheProbabilityAskedFor) {
  for (const MaskRule rule : {MaskRule::Corrected, MaskRule::Literal}) {
    int selected = 0;
    constexpr int kSide = 256;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) selected += threshold(x, y, 5, 1, rule) < 0.2F;
    // Independent numbers: 4 standard deviations of the count.
    EXPECT_NEAR(selected, 0.2 * kSide * kSide, 4.0 * 103.0);
  }
}

}  // namespace
}  // namespace macula::kernels::sphere
