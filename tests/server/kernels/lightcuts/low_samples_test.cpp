// T-SLC-2 and T-SLC-3: lights that another point drew leave the mean as it is; the printed rules do
// not.
#include "server/kernels/lightcuts/low_samples.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "tests/server/kernels/lightcuts/many_points.h"

namespace macula::kernels::lightcuts {
namespace {

using lights::LeafChoice;
using lights::LightTree;
using lights::LightWalk;
using lights::NodeId;
using lights::Receiver;
using lights::WeightRule;
using lights::test::Random;
using test::Lit;

/// The low pixel's draws; a wall hides half of the lights from it.
LowSamples drawn(const Lit& lit, const Receiver& low, std::size_t nodes, Random& random) {
  const LightWalk walk(lit.tree, low, WeightRule::Defensive);
  lights::LightCut cut;
  walk.cut(nodes, cut);
  std::vector<LowSample> samples;
  for (const auto* part : {&cut.nodes, &cut.dark}) {
    for (const NodeId node : *part) {
      const LeafChoice choice = walk.choose(node, random.next());
      const double open = lit.light(choice.leaf, low) / choice.probability;
      const bool hidden = lit.lights[*lit.tree.light_at(choice.leaf)].centre.x > 0.0F;
      samples.push_back({node, choice.leaf, choice.probability, static_cast<float>(open),
                         hidden ? 0.0F : static_cast<float>(open)});
    }
  }
  return {low, std::move(samples)};
}

struct Estimate {
  static constexpr int kSeeds = 6000;
  double mean = 0.0, error = 0.0;
  int taken = 0;

  bool agrees(double wanted) const { return std::abs(mean - wanted) < 4.5 * error + 1e-9; }
};
using Rule = std::function<LeafChoice(const LowSamples&, NodeId, double)>;

/// The light of `node` at `near` by draws made at `low`.
Estimate estimate(const Lit& lit, const Receiver& low, const Receiver& near, NodeId node,
                  std::size_t low_nodes, const Rule& rule) {
  Random random(11);
  const LightWalk own(lit.tree, near);
  constexpr int kSeeds = Estimate::kSeeds;
  double sum = 0.0, square = 0.0;
  Estimate made;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const LowSamples samples = drawn(lit, low, low_nodes, random);
    LeafChoice choice = rule(samples, node, random.next());
    if (choice.probability == 0.0) {
      choice = own.choose(node, random.next());
    } else {
      ++made.taken;
    }
    const double value = choice.leaf == 0 ? 0.0 : lit.light(choice.leaf, near) / choice.probability;
    sum += value, square += value * value;
  }
  made.mean = sum / kSeeds;
  made.error = std::sqrt(std::max(square / kSeeds - made.mean * made.mean, 0.0) / kSeeds);
  return made;
}

const Receiver kLow{{0.3F, -1.4F, 0.2F}, {0.0F, 1.0F, 0.0F}};
/// A pixel beside it, one around the corner, one that sees what is behind the low pixel.
const Receiver kNear[] = {{{0.4F, -1.4F, 0.3F}, {0.0F, 1.0F, 0.0F}},
                          {{0.3F, -0.9F, 0.2F}, {1.0F, 0.0F, 0.0F}},
                          {{0.2F, 0.6F, 0.1F}, {0.0F, -1.0F, 0.0F}}};

Rule corrected(const LightTree& tree) {
  return [&tree](const LowSamples& samples, NodeId node, double u) {
    return samples.take(tree, node, u);
  };
}

TEST(LowSamples, TakenLightsLeaveTheMeanWhereANodeHoldsManyOfTheLowCut) {
  const Lit lit;
  for (const Receiver& near : kNear) {
    for (const NodeId node : {1U, 2U, 3U, 5U, 6U}) {
      const Estimate got = estimate(lit, kLow, near, node, 24, corrected(lit.tree));
      EXPECT_TRUE(got.agrees(lit.sum(node, near)))
          << node << ": " << got.mean << " +- " << got.error << ", " << lit.sum(node, near);
      EXPECT_EQ(got.taken, Estimate::kSeeds);
      EXPECT_FALSE(got.agrees(1.3 * lit.sum(node, near)) && node == 1U) << "30 % would be seen";
    }
  }
}

TEST(LowSamples, TakenLightsLeaveTheMeanWhereANodeLiesBelowTheLowCut) {
  const Lit lit;
  for (const NodeId node : {2U, 3U, 6U, 12U, 20U, 50U}) {
    const Estimate got = estimate(lit, kLow, kNear[0], node, 1, corrected(lit.tree));
    EXPECT_TRUE(got.agrees(lit.sum(node, kNear[0])))
        << node << ": " << got.mean << " +- " << got.error << ", " << lit.sum(node, kNear[0]);
    EXPECT_GT(got.taken, 0);
    EXPECT_LT(got.taken, Estimate::kSeeds);
  }
}

/// Several lights of one low pixel, drawn evenly over what all of its samples brought, in place of
/// one for each node.
TEST(LowSamples, SeveralLightsDrawnOfAllSamplesLeaveTheMean) {
  const Lit lit;
  constexpr int kTaken = 5;
  for (const Receiver& near : kNear) {
    double sum = 0.0, square = 0.0, equal = 0.0;
    Random random(12);
    for (int seed = 0; seed < Estimate::kSeeds; ++seed) {
      const LowSamples samples = drawn(lit, kLow, 24, random);
      const auto count = static_cast<double>(samples.samples().size());
      double light = 0.0;
      for (int k = 0; k < kTaken; ++k) {
        const LeafChoice choice = samples.take(lit.tree, 1, (k + random.next()) / kTaken);
        if (choice.leaf == 0) continue;
        light += lit.light(choice.leaf, near) / choice.probability / kTaken;
        for (const LowSample& one : samples.samples())
          if (one.leaf == choice.leaf)
            equal += lit.light(one.leaf, near) * count / one.probability / kTaken;
      }
      sum += light, square += light * light;
    }
    constexpr int kSeeds = Estimate::kSeeds;
    Estimate got{sum / kSeeds, 0.0, kSeeds};
    got.error = std::sqrt(std::max(square / kSeeds - got.mean * got.mean, 0.0) / kSeeds);
    EXPECT_TRUE(got.agrees(lit.sum(1, near))) << got.mean << " +- " << got.error;
    EXPECT_GT(std::abs(equal / kSeeds - lit.sum(1, near)), 9.0 * got.error)
        << "as if all samples were alike";
  }
}

/// The nearest node's light, as Algorithm 2 prints it: the nodes of the low cut inside `node` are
/// not all given a chance.
TEST(LowSamples, TheNearestNodeAloneLosesLight) {
  const Lit lit;
  const Rule nearest = [](const LowSamples& samples, NodeId node, double) {
    const LowSample* best = nullptr;
    for (const LowSample& sample : samples.samples()) {
      const int down = lights::level_of(sample.node) - lights::level_of(node);
      if (down < 0 || sample.node >> down != node) continue;
      if (best == nullptr || lights::level_of(sample.node) < lights::level_of(best->node)) {
        best = &sample;
      }
    }
    return best == nullptr ? LeafChoice{0, 0.0} : LeafChoice{best->leaf, best->probability};
  };
  const Estimate got = estimate(lit, kLow, kNear[0], 1, 24, nearest);
  EXPECT_FALSE(got.agrees(lit.sum(1, kNear[0])));
  EXPECT_LT(got.mean, 0.9 * lit.sum(1, kNear[0]));
}

/// A taken light over the probability that the pixel's own walk would have had.
TEST(LowSamples, TheProbabilityOfTheWalkNotMadeIsWrong) {
  const Lit lit;
  const LightWalk own(lit.tree, kNear[0]);
  for (const std::size_t low_nodes : {1UL, 24UL}) {
    const Rule printed = [&](const LowSamples& samples, NodeId node, double u) {
      LeafChoice choice = samples.take(lit.tree, node, u);
      if (choice.leaf != 0) choice.probability = own.probability(node, choice.leaf);
      return choice.probability > 0.0 ? choice : LeafChoice{0, 1.0};
    };
    const NodeId node = low_nodes == 1 ? 3U : 1U;
    EXPECT_FALSE(
        estimate(lit, kLow, kNear[0], node, low_nodes, printed).agrees(lit.sum(node, kNear[0])));
  }
}

TEST(LowSamples, WithoutSamplesAWalkIsAskedFor) {
  const Lit lit;
  const LowSamples none({}, {});
  const LeafChoice choice = none.take(lit.tree, 1, 0.5);
  EXPECT_EQ(choice.leaf, 0U);
  EXPECT_EQ(choice.probability, 0.0);
}

}  // namespace
}  // namespace macula::kernels::lightcuts
