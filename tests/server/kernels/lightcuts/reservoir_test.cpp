// T-RIS: a light that another point drew, by pairwise MIS, and the weights that must fail.
#include "server/kernels/lightcuts/reservoir.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/server/kernels/lightcuts/many_points.h"

namespace macula::kernels::lightcuts {
namespace {

using lights::LeafChoice;
using lights::LightWalk;
using lights::Receiver;
using lights::test::Random;
using test::Lit;

TEST(Reservoir, SharesOfALightAddUpToOne) {
  Random random(1);
  for (int i = 0; i < 10'000; ++i) {
    const int pairs = 1 + static_cast<int>(3.0 * random.next());
    const auto target = [&] {
      return static_cast<float>(random.next() < 0.2 ? 0.0 : std::exp(20.0 * random.next() - 10.0));
    };
    const float own = target() + 1e-6F;
    float sum = 0.0F;
    for (int k = 0; k < pairs; ++k) {
      const PairedTargets targets{own, target()};
      sum += own_share(targets, pairs) + other_share(targets, pairs);
    }
    EXPECT_NEAR(sum, 1.0F, 1e-6F);
  }
}

struct Estimate {
  double mean = 0.0, error = 0.0;

  bool agrees(double wanted) const { return std::abs(mean - wanted) < 4.5 * error; }
};
enum class Weights { Pairwise, Equal };

/// All light at `own` by one light drawn there and one drawn at each neighbour, whose walks know
/// nothing of what lies behind them.
Estimate estimate(const Lit& lit, const Receiver& own, const std::vector<Receiver>& others,
                  Weights weights) {
  Random random(2);
  const auto target = [&](const LeafChoice& choice, const Receiver& at) {
    return choice.leaf == 0 ? 0.0F : static_cast<float>(lit.light(choice.leaf, at));
  };
  const int pairs = static_cast<int>(others.size());
  constexpr float kConfidence = 6.0F;
  const float equal = 1.0F / static_cast<float>(pairs + 1);
  constexpr int kSeeds = 20'000;
  double sum = 0.0, square = 0.0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    double value = 0.0;
    const LeafChoice mine = LightWalk(lit.tree, own).choose(1, random.next());
    float share = 0.0F;
    for (const Receiver& at : others) {
      share += own_share({target(mine, own), kConfidence * target(mine, at)}, pairs);
      const LeafChoice theirs = LightWalk(lit.tree, at).choose(1, random.next());
      const float there = target(theirs, at), here = target(theirs, own);
      if (!(there > 0.0F)) continue;
      const float other =
          weights == Weights::Equal ? equal : other_share({here, kConfidence * there}, pairs);
      value += static_cast<double>(other * here) / theirs.probability;
    }
    if (weights == Weights::Equal) share = equal;
    if (mine.leaf != 0) value += static_cast<double>(share * target(mine, own)) / mine.probability;
    sum += value, square += value * value;
  }
  const double mean = sum / kSeeds;
  return {mean, std::sqrt((square / kSeeds - mean * mean) / kSeeds)};
}

const Receiver kFloor{{0.1F, -1.3F, 0.2F}, {0.0F, 1.0F, 0.0F}};
const Receiver kWall{{-1.3F, -1.2F, 0.2F}, {1.0F, 0.0F, 0.0F}};
const Receiver kCeiling{{0.1F, 0.4F, 0.2F}, {0.0F, -1.0F, 0.0F}};

TEST(Reservoir, ALightDrawnOnAnotherSurfaceLeavesTheMeanUnchanged) {
  const Lit lit;
  for (const auto& others :
       {std::vector{kWall}, std::vector{kCeiling}, std::vector{kWall, kCeiling}}) {
    const Estimate got = estimate(lit, kFloor, others, Weights::Pairwise);
    const double wanted = lit.sum(1, kFloor);
    EXPECT_TRUE(got.agrees(wanted)) << got.mean << " +- " << got.error << ", " << wanted;
    EXPECT_FALSE(got.agrees(1.1 * wanted)) << "10 % would be seen";
  }
}

TEST(Reservoir, EqualWeightsLoseWhatTheOtherSurfaceCannotSee) {
  const Lit lit;
  const Estimate got = estimate(lit, kFloor, {kCeiling}, Weights::Equal);
  EXPECT_FALSE(got.agrees(lit.sum(1, kFloor)));
  EXPECT_LT(got.mean, lit.sum(1, kFloor));
}

}  // namespace
}  // namespace macula::kernels::lightcuts
