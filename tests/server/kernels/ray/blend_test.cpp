#include "server/kernels/ray/blend.h"

#include <gtest/gtest.h>

#include <cmath>

namespace macula::kernels::ray {
namespace {

TEST(Blend, WithoutALimitTheMemoryIsARunningMean) {
  float samples = 0.0F;
  for (int n = 1; n <= 100; ++n) {
    const float alpha = weight(samples, 0.0F, WeightRule::AtLeastLimit);
    EXPECT_NEAR(alpha, 1.0F / static_cast<float>(n), 1e-5F);
    samples = samples_after(samples, alpha);
    EXPECT_NEAR(samples, static_cast<float>(n), 1e-3F);
  }
}

// rho* = (2 - k) / k is the fixed point of 1 / (k^2 + (1 - k)^2 / rho).
TEST(Blend, UnderALimitAMemoryIsWorthAtMostTwoByTheLimitLessOne) {
  for (const float limit : {0.05F, 0.1F, 0.2F, 1.0F}) {
    float samples = 0.0F;
    for (int n = 0; n < 500; ++n) {
      samples = samples_after(samples, weight(samples, limit, WeightRule::AtLeastLimit));
    }
    EXPECT_NEAR(samples, (2.0F - limit) / limit, 1e-2F) << limit;
  }
}

TEST(Blend, TheFirstSampleCountsInFullUnlessPrintedFormsAreAskedFor) {
  EXPECT_EQ(weight(0.0F, 0.1F, WeightRule::AtLeastLimit), 1.0F);
  EXPECT_EQ(samples_after(0.0F, 1.0F), 1.0F);
  // As printed a third of the black start is left after ten frames: 0.9^10.
  float black = 1.0F;
  for (int n = 0; n < 10; ++n) black *= 1.0F - weight(0.0F, 0.1F, WeightRule::AtMostLimit);
  EXPECT_NEAR(black, 0.349F, 1e-3F);
}

TEST(Blend, TheLeastWeightRisesFromItsLeastToItsMostAsPublished) {
  const AgeLimits limits{0.1F, 0.9F, 8};
  const float expected[] = {0.10F, 0.14F, 0.19F, 0.26F, 0.35F, 0.48F, 0.66F, 0.90F};
  for (std::uint32_t age = 1; age <= 8; ++age) {
    EXPECT_NEAR(least_weight(limits, age), expected[age - 1], 0.006F) << age;
  }
  EXPECT_FLOAT_EQ(least_weight(limits, 0), 0.1F);
  EXPECT_FLOAT_EQ(least_weight(limits, 100'000), 0.9F);
}

TEST(Blend, LimitsAtTheirExtremesStayDefined) {
  EXPECT_EQ(least_weight({0.1F, 0.9F, 1}, 5), 0.9F);
  EXPECT_EQ(least_weight({0.1F, 0.9F, 0}, 5), 0.9F);
  EXPECT_FLOAT_EQ(least_weight({0.3F, 0.3F, 8}, 4), 0.3F);
  EXPECT_FLOAT_EQ(least_weight({1.0F, 1.0F, 8}, 4), 1.0F);
}

}  // namespace
}  // namespace macula::kernels::ray
