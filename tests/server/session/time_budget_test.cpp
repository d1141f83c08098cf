#include "server/session/time_budget.h"

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

double settle(TimeBudget& budget, CostModel& cost, int frames) {
  for (int i = 0; i < frames; ++i) budget.on_frame(units::from_ms(cost(budget.scale())));
  return budget.scale();
}

TEST(TimeBudget, WithoutATargetQualityStaysFull) {
  TimeBudget budget;
  CostModel cost{.full_ms = 500.0};
  EXPECT_EQ(settle(budget, cost, 100), 1.0);
}

TEST(TimeBudget, StaysAtFullQualityWhileFramesFit) {
  TimeBudget budget{units::from_ms(50)};
  CostModel cost;
  EXPECT_EQ(settle(budget, cost, 100), 1.0);
}

// 1 + 40 s^2 = 20 has its solution at s = 0.689.
TEST(TimeBudget, BringsAHeavySceneToItsTarget) {
  TimeBudget budget{units::from_ms(20)};
  CostModel cost;
  const double scale = settle(budget, cost, 60);
  const double ms = cost(scale);
  EXPECT_LE(ms, 20.0 * 1.05);
  EXPECT_GE(ms, 20.0 * 0.70);
}

TEST(TimeBudget, DoesNotOscillateUnderASteadyLoad) {
  for (double full_ms = 21.0; full_ms < 130.0; full_ms += 3.7) {
    TimeBudget budget{units::from_ms(20)};
    CostModel cost{.full_ms = full_ms};
    const double settled = settle(budget, cost, 150);
    for (int i = 0; i < 100; ++i) {
      budget.on_frame(units::from_ms(cost(budget.scale())));
      ASSERT_EQ(budget.scale(), settled) << "full cost " << full_ms << " ms";
    }
  }
}

TEST(TimeBudget, NoiseOfATenthMovesItRarely) {
  TimeBudget budget{units::from_ms(20)};
  CostModel cost{.noise = 0.1};
  double scale = settle(budget, cost, 100);
  int changes = 0;
  for (int i = 0; i < 500; ++i) {
    budget.on_frame(units::from_ms(cost(budget.scale())));
    changes += budget.scale() != scale ? 1 : 0;
    scale = budget.scale();
  }
  EXPECT_LE(changes, 5);
}

TEST(TimeBudget, FollowsALoadThatComesAndGoes) {
  TimeBudget budget{units::from_ms(20)};
  CostModel light{.full_ms = 10.0}, heavy{.full_ms = 60.0};
  EXPECT_EQ(settle(budget, light, 50), 1.0);
  EXPECT_LT(settle(budget, heavy, 50), 0.62);
  EXPECT_EQ(settle(budget, light, 150), 1.0);
}

TEST(TimeBudget, NeverGoesBelowItsLeastScale) {
  TimeBudget budget{units::from_ms(1)};
  CostModel cost{.full_ms = 1000.0};
  EXPECT_DOUBLE_EQ(settle(budget, cost, 100), TimeBudget::kLeastScale);
}

}  // namespace
}  // namespace macula::session
