#include "server/session/governor.h"

#include <gtest/gtest.h>
#include <cmath>

#include "shared/math/hash.h"

namespace macula::session {
namespace {

/// Cost model: a fixed part and a part that goes with the number of cells, i.e. with scale^2, times
/// noise of +-`noise`.
struct CostModel {
  double fixed_ms = 1.0, full_ms = 40.0, noise = 0.0;
  std::uint64_t frame = 0;
  double operator()(double scale) {
    const double u = 2.0 * math::unit_float(math::hash_mix(++frame)) - 1.0;
    return (fixed_ms + full_ms * scale * scale) * (1.0 + noise * u);
  }
};

double settle(Governor& governor, CostModel& cost, int frames) {
  for (int i = 0; i < frames; ++i) governor.on_frame(units::from_ms(cost(governor.scale())));
  return governor.scale();
}

TEST(Governor, WithoutATargetQualityStaysFull) {
  Governor governor;
  CostModel cost{.full_ms = 500.0};
  EXPECT_EQ(settle(governor, cost, 100), 1.0);
}

TEST(Governor, StaysAtFullQualityWhileFramesFit) {
  Governor governor{units::from_ms(50)};
  CostModel cost;
  EXPECT_EQ(settle(governor, cost, 100), 1.0);
}

// 1 + 40 s^2 = 20 has its solution at s = 0.689.
TEST(Governor, BringsAHeavySceneToItsTarget) {
  Governor governor{units::from_ms(20)};
  CostModel cost;
  const double scale = settle(governor, cost, 60);
  const double ms = cost(scale);
  EXPECT_LE(ms, 20.0 * 1.05);
  EXPECT_GE(ms, 20.0 * 0.70);
}

TEST(Governor, DoesNotOscillateUnderASteadyLoad) {
  for (double full_ms = 21.0; full_ms < 130.0; full_ms += 3.7) {
    Governor governor{units::from_ms(20)};
    CostModel cost{.full_ms = full_ms};
    const double settled = settle(governor, cost, 150);
    for (int i = 0; i < 100; ++i) {
      governor.on_frame(units::from_ms(cost(governor.scale())));
      ASSERT_EQ(governor.scale(), settled) << "full cost " << full_ms << " ms";
    }
  }
}

TEST(Governor, NoiseOfATenthMovesItRarely) {
  Governor governor{units::from_ms(20)};
  CostModel cost{.noise = 0.1};
  double scale = settle(governor, cost, 100);
  int changes = 0;
  for (int i = 0; i < 500; ++i) {
    governor.on_frame(units::from_ms(cost(governor.scale())));
    changes += governor.scale() != scale ? 1 : 0;
    scale = governor.scale();
  }
  EXPECT_LE(changes, 5);
}

TEST(Governor, FollowsALoadThatComesAndGoes) {
  Governor governor{units::from_ms(20)};
  CostModel light{.full_ms = 10.0}, heavy{.full_ms = 60.0};
  EXPECT_EQ(settle(governor, light, 50), 1.0);
  EXPECT_LT(settle(governor, heavy, 50), 0.62);
  EXPECT_EQ(settle(governor, light, 150), 1.0);
}

TEST(Governor, NeverGoesBelowItsLeastScale) {
  Governor governor{units::from_ms(1)};
  CostModel cost{.full_ms = 1000.0};
  EXPECT_DOUBLE_EQ(settle(governor, cost, 100), Governor::kLeastScale);
}

}  // namespace
}  // namespace macula::session
