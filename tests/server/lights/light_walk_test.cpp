// T-TREE-3, T-TREE-4 and the unshadowed part of T-SLC: what a receiver is told of the lights.
#include "server/lights/light_walk.h"

#include <set>

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include "tests/server/lights/tree_oracle.h"

namespace macula::lights {
namespace {

using test::Kind;
using test::Random;
using test::random_lights;

/// Within the lights' cube or up to three of its half sides away.
Receiver random_receiver(Random& random) {
  const double reach = random.next() < 0.5 ? 1.0 : 4.0;
  const Vec3 position = random.in_cube(reach);
  return {position, random.direction()};
}

constexpr WeightRule kRules[] = {WeightRule::NearAndFar, WeightRule::NearOrIntensity};

// ---- bounds ----

TEST(LightWalk, BoundsAreThoseOfTheOracle) {
  Random random(1);
  for (const Kind kind : {Kind::Points, Kind::Patches, Kind::Mixed}) {
    const LightTree tree(random_lights(300, kind, 2));
    const double brightest = [&] {
      double most = 0.0;
      for (NodeId leaf = tree.first_leaf(); tree.light_at(leaf); ++leaf) {
        most = std::max(most, tree.node(leaf).bounds.intensity);
      }
      return most;
    }();
    for (int i = 0; i < 3000; ++i) {
      const Receiver receiver = random_receiver(random);
      const auto node = static_cast<NodeId>(1 + random.next() * (2.0 * tree.first_leaf() - 1.0));
      const NodeView got = LightWalk(tree, receiver).view(node);
      if (tree.node(node).empty) {
        EXPECT_EQ(got.weight, 0.0F);
        continue;
      }
      const test::View wanted = test::view_of(tree.node(node).bounds, receiver);
      const double scale = tree.node(node).bounds.intensity / brightest;
      EXPECT_NEAR(got.weight / scale, wanted.weight / (scale * brightest), 3e-3);
      EXPECT_NEAR(got.near2_m2, wanted.near2, 1e-5 * (1.0 + wanted.near2));
      EXPECT_NEAR(got.far2_m2, wanted.far2, 1e-5 * wanted.far2);
    }
  }
}

// T-TREE-4: weight over the least squared distance is never below what the node's lights send.
TEST(LightWalk, NoNodeSendsMoreThanItsBound) {
  Random random(3);
  int below = 0, reachable = 0;
  for (const Kind kind : {Kind::Points, Kind::Patches, Kind::Mixed}) {
    const auto lights = random_lights(500, kind, 4);
    const LightTree tree(lights);
    double brightest = 0.0;
    for (const LightBounds& light : lights) brightest = std::max(brightest, light.intensity);
    for (int i = 0; i < 2000; ++i) {
      const Receiver receiver = random_receiver(random);
      const auto level = static_cast<int>(random.next() * 10.0);
      const auto node = (NodeId{1} << level) + static_cast<NodeId>(random.next() * (1 << level));
      double sent = 0.0;
      const LeafRange range = tree.leaves(node);
      for (NodeId leaf = range.first; leaf <= range.last && tree.light_at(leaf); ++leaf) {
        LightBounds light = lights[*tree.light_at(leaf)];
        light.centre += light.half * random.in_cube(1.0);  // anywhere in its box
        const Vec3 away = light.centre - receiver.position;
        sent += test::reaching(light, receiver) / static_cast<double>(glm::dot(away, away));
      }
      const NodeView view = LightWalk(tree, receiver).view(node);
      const double bound = brightest * view.weight / static_cast<double>(view.near2_m2);
      below += !(sent <= bound * (1.0 + 1e-5) + 1e-7);
      reachable += sent > 0.0;
    }
  }
  EXPECT_EQ(below, 0);
  EXPECT_GT(reachable, 2000);
}

// ---- probabilities ----

double light_sum(const LightTree& tree, const std::vector<LightBounds>& lights,
                 const Receiver& receiver, NodeId node) {
  double sum = 0.0;
  const LeafRange range = tree.leaves(node);
  for (NodeId leaf = range.first; leaf <= range.last; ++leaf) {
    if (!tree.light_at(leaf)) break;
    const LightBounds& light = lights[*tree.light_at(leaf)];
    const Vec3 away = light.centre - receiver.position;
    sum += test::reaching(light, receiver) / static_cast<double>(glm::dot(away, away));
  }
  return sum;
}

TEST(LightWalk, ProbabilitiesAreThoseOfTheOracle) {
  Random random(5);
  for (const Kind kind : {Kind::Points, Kind::Patches}) {
    const LightTree tree(random_lights(900, kind, 6));
    for (int i = 0; i < 300; ++i) {
      const Receiver receiver = random_receiver(random);
      const NodeId leaf = tree.first_leaf() + static_cast<NodeId>(random.next() * 900.0);
      const NodeId node = leaf >> static_cast<int>(random.next() * 11.0);
      const double wanted = test::probability(tree, receiver, node, leaf);
      EXPECT_NEAR(LightWalk(tree, receiver).probability(node, leaf), wanted, 0.01 * wanted + 1e-6);
    }
  }
}

TEST(LightWalk, AnInnerNodeIsAsLikelyAsItsLeavesTogether) {
  Random random(15);
  const LightTree tree(random_lights(900, Kind::Mixed, 16));
  for (const WeightRule rule : {WeightRule::NearAndFar, WeightRule::Defensive}) {
    for (int i = 0; i < 60; ++i) {
      const LightWalk walk(tree, random_receiver(random), rule);
      const NodeId leaf = tree.first_leaf() + static_cast<NodeId>(random.next() * 900.0);
      const NodeId inner = leaf >> static_cast<int>(random.next() * 8.0);
      const NodeId node = inner >> static_cast<int>(random.next() * 4.0);
      if (node == 0) continue;
      double sum = 0.0;
      const LeafRange leaves = tree.leaves(inner);
      for (NodeId each = leaves.first; each <= leaves.last; ++each) {
        sum += walk.probability(node, each);
      }
      // A branch alive from above may be dead below: only Defensive walks never end there.
      const double whole = walk.probability(node, inner);
      if (rule == WeightRule::Defensive) {
        EXPECT_NEAR(whole, sum, 1e-5 * whole + 1e-12);
      } else {
        EXPECT_GE(whole, sum - 1e-5 * whole);
      }
    }
  }
}

TEST(LightWalk, ADefensiveWalkMayEndAtEveryLightSeenOrNot) {
  Random random(17);
  const auto lights = random_lights(300, Kind::Mixed, 18);
  const LightTree tree(lights);
  LightCut cut;
  for (int i = 0; i < 30; ++i) {
    const Receiver receiver = random_receiver(random);
    const LightWalk walk(tree, receiver, WeightRule::Defensive);
    double total = 0.0;
    for (NodeId leaf = tree.first_leaf(); tree.light_at(leaf); ++leaf) {
      EXPECT_GT(walk.probability(1, leaf), 0.0);
      total += walk.probability(1, leaf);
    }
    EXPECT_NEAR(total, 1.0, 1e-5);
    walk.cut(24, cut);
    std::size_t held = 0;
    for (const auto* part : {&cut.nodes, &cut.dark}) {
      for (const NodeId node : *part) {
        const LeafRange leaves = tree.leaves(node);
        for (NodeId leaf = leaves.first; leaf <= leaves.last; ++leaf) {
          held += tree.light_at(leaf).has_value();
        }
      }
    }
    EXPECT_EQ(held, lights.size()) << "dark nodes hold what the cut has dropped";
  }
}

// T-TREE-3: leaves' chances add up to 1, or to 0 where no light reaches the receiver.
TEST(LightWalk, ProbabilitiesOfAllLeavesAddUpToOne) {
  Random random(7);
  for (const Kind kind : {Kind::Points, Kind::Patches, Kind::Mixed}) {
    for (const std::size_t n : {1UL, 2UL, 3UL, 17UL, 100UL, 600UL}) {
      const auto lights = random_lights(n, kind, n);
      const LightTree tree(lights);
      for (int i = 0; i < 20; ++i) {
        Receiver receiver = random_receiver(random);
        // Below all lights, facing up: nothing is dead.
        if (i % 2 == 0) receiver = {random.in_cube(1.0) - Vec3{0, 2.5F, 0}, {0, 1, 0}};
        for (const WeightRule rule : kRules) {
          const LightWalk walk(tree, receiver, rule);
          double total = 0.0, dark = 0.0;
          for (NodeId leaf = tree.first_leaf(); leaf < 2 * tree.first_leaf(); ++leaf) {
            const double p = walk.probability(1, leaf);
            total += p;
            if (!tree.light_at(leaf)) {
              EXPECT_EQ(p, 0.0) << "padding is never drawn";
            }
            if (p == 0.0) dark += light_sum(tree, lights, receiver, leaf);
          }
          EXPECT_EQ(dark, 0.0) << "what is never drawn never shines";
          // A branch that seemed alive from above may be dead below: its chance is lost, and
          // nothing else.
          EXPECT_LE(total, 1.0 + 1e-6);
          const bool all_in_sight = i % 2 == 0 && kind == Kind::Points;
          if (all_in_sight) {
            EXPECT_NEAR(total, 1.0, 1e-6);
          }
        }
      }
    }
  }
}

TEST(LightWalk, LeavesAreDrawnAsOftenAsTheirProbabilitySays) {
  Random random(8);
  const LightTree tree(random_lights(100, Kind::Mixed, 9));
  constexpr int kDraws = 20000;
  for (const WeightRule rule : kRules) {
    for (int i = 0; i < 10; ++i) {
      const LightWalk walk(tree, random_receiver(random), rule);
      std::vector<int> drawn(2 * tree.first_leaf());
      for (int k = 0; k < kDraws; ++k) {
        const LeafChoice choice = walk.choose(1, random.next());
        ++drawn[choice.leaf];
        if (choice.leaf != 0) {
          EXPECT_NEAR(choice.probability / walk.probability(1, choice.leaf), 1.0, 1e-6);
        }
      }
      double dead_ends = 1.0;
      for (NodeId leaf = tree.first_leaf(); leaf < 2 * tree.first_leaf(); ++leaf) {
        const double p = walk.probability(1, leaf);
        dead_ends -= p;
        EXPECT_NEAR(drawn[leaf] / double{kDraws}, p, 5.0 * std::sqrt(p / kDraws) + 1e-12);
      }
      EXPECT_NEAR(drawn[0] / double{kDraws}, dead_ends, 5.0 * std::sqrt(0.25 / kDraws));
    }
  }
}

TEST(LightWalk, TheEndsOfTheUnitIntervalAreLeavesToo) {
  Random random(10);
  for (const std::size_t n : {1UL, 5UL, 33UL, 1000UL}) {
    const LightTree tree(random_lights(n, Kind::Points, n));
    for (int i = 0; i < 50; ++i) {
      const LightWalk walk(tree, random_receiver(random));
      for (const double u : {0.0, 1.0 - 0x1p-53}) {
        const LeafChoice choice = walk.choose(1, u);
        if (choice.leaf == 0) continue;
        EXPECT_TRUE(tree.light_at(choice.leaf));
        EXPECT_GT(choice.probability, 0.0);
      }
    }
  }
}

// ---- many walks at once ----

/// From nodes of any level, leaves too; every seventh receiver, under the lights and facing down,
/// is reached by none.
std::vector<Descent> random_descents(const LightTree& tree, std::size_t count, Random& random) {
  std::vector<Descent> descents;
  for (std::size_t i = 0; i < count; ++i) {
    Receiver receiver = random_receiver(random);
    if (i % 7 == 3) receiver = {{0.0F, -5.0F, 0.0F}, {0.0F, -1.0F, 0.0F}};
    const NodeId leaf = tree.first_leaf() + static_cast<NodeId>(random.next() * 900.0);
    descents.push_back({receiver, leaf >> static_cast<int>(random.next() * 11.0), random.next()});
  }
  return descents;
}

TEST(LightWalk, WalksMadeTogetherEndWhereEachEndsAlone) {
  int found = 0, dark = 0, sets = 0;
  for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
    hwy::SetSupportedTargetsForTest(rest & -rest);
    ++sets;
    Random random(20);
    for (const Kind kind : {Kind::Points, Kind::Mixed}) {
      const LightTree tree(random_lights(900, kind, 21));
      for (const WeightRule rule : kRules) {
        for (const std::size_t count : {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 15, 16, 17, 300}) {
          const auto descents = random_descents(tree, count, random);
          std::vector<LeafChoice> choices(count);
          choose_each(tree, rule, descents, choices);
          for (std::size_t i = 0; i < count; ++i) {
            const Descent& descent = descents[i];
            const LeafChoice alone =
                LightWalk(tree, descent.receiver, rule).choose(descent.node, descent.u);
            ASSERT_EQ(choices[i].leaf, alone.leaf) << i << " of " << count;
            ASSERT_EQ(choices[i].probability, alone.probability);
            if (choices[i].leaf != 0) {
              ++found;
            } else {
              ++dark;
            }
          }
        }
      }
    }
    hwy::SetSupportedTargetsForTest(0);
  }
  EXPECT_GT(found, 500 * sets);
  EXPECT_GT(dark, 100 * sets);
}

// ---- the cut ----

TEST(LightWalk, ACutHoldsEveryLightThatShinesExactlyOnce) {
  Random random(11);
  for (const Kind kind : {Kind::Points, Kind::Patches, Kind::Mixed}) {
    for (const std::size_t n : {1UL, 2UL, 3UL, 31UL, 33UL, 700UL}) {
      const auto lights = random_lights(n, kind, n);
      const LightTree tree(lights);
      LightCut cut;
      for (const std::size_t most : {1UL, 4UL, 48UL, 2000UL}) {
        const Receiver receiver = random_receiver(random);
        LightWalk(tree, receiver).cut(most, cut);
        EXPECT_LE(cut.nodes.size(), most);
        std::set<NodeId> leaves;
        double sum = 0.0;
        for (const NodeId node : cut.nodes) {
          const LeafRange range = tree.leaves(node);
          for (NodeId leaf = range.first; leaf <= range.last; ++leaf) {
            EXPECT_TRUE(leaves.insert(leaf).second) << "twice";
          }
          sum += light_sum(tree, lights, receiver, node);
        }
        const double all = light_sum(tree, lights, receiver, 1);
        EXPECT_NEAR(sum, all, 1e-9 * all);
        if (most >= n) {
          for (const NodeId node : cut.nodes) EXPECT_TRUE(tree.is_leaf(node));
        }
      }
    }
  }
}

struct Estimate {
  double mean, standard_error;
};
/// Unshadowed light at the receiver by one leaf of each node of its cut; `bias` 1 is right.
Estimate estimate(const LightTree& tree, const std::vector<LightBounds>& lights,
                  const Receiver& receiver, std::size_t most_nodes, WeightRule rule, Random& random,
                  double bias = 0.0) {
  const LightWalk walk(tree, receiver, rule);
  LightCut cut;
  walk.cut(most_nodes, cut);
  std::vector<double> lit(2 * tree.first_leaf());
  for (NodeId leaf = tree.first_leaf(); leaf < 2 * tree.first_leaf(); ++leaf) {
    lit[leaf] = light_sum(tree, lights, receiver, leaf);
  }
  double sum = 0.0, square = 0.0;
  const int seeds = most_nodes > 4 ? 512 : 4096;
  for (int seed = 0; seed < seeds; ++seed) {
    double value = 0.0;
    for (const NodeId node : cut.nodes) {
      const LeafChoice choice = walk.choose(node, random.next());
      if (choice.leaf == 0) continue;
      // Must-fail twin: a share of the lights' intensities within the walk's own probability.
      double p = choice.probability;
      if (bias > 0.0) {
        const auto intensity = [&](NodeId id) { return tree.node(id).bounds.intensity; };
        p = (1.0 - bias) * p + bias * intensity(choice.leaf) / intensity(node);
      }
      value += lit[choice.leaf] / p;
    }
    sum += value, square += value * value;
  }
  const double mean = sum / seeds;
  return {mean, std::sqrt(std::max(square / seeds - mean * mean, 0.0) / seeds)};
}

int misses(std::size_t most_nodes, Kind kind, WeightRule rule, double bias) {
  const auto lights = random_lights(1000, kind, 12);
  const LightTree tree(lights);
  Random random(13);
  int missed = 0;
  for (int point = 0; point < 64; ++point) {
    const Receiver receiver = random_receiver(random);
    const double exact = light_sum(tree, lights, receiver, 1);
    const Estimate got = estimate(tree, lights, receiver, most_nodes, rule, random, bias);
    missed += std::abs(got.mean - exact) > 4.0 * got.standard_error + 1e-5 * exact;
  }
  return missed;
}

// T-SLC-1: the mean is the sum over all lights, and its must-fail twin.
TEST(LightWalk, ARandomLeafOfEachCutNodeGivesAllTheLightOnAverage) {
  for (const std::size_t nodes : {1UL, 4UL, 48UL}) {
    for (const WeightRule rule : kRules) {
      EXPECT_LE(misses(nodes, Kind::Points, rule, 0.0), 1) << nodes;
    }
    EXPECT_LE(misses(nodes, Kind::Patches, WeightRule::NearAndFar, 0.0), 1) << nodes;
    EXPECT_GT(misses(nodes, Kind::Points, WeightRule::NearAndFar, 0.2), 10) << nodes;
  }
}

// T-SLC-4: with as many nodes as lights there is nothing left to chance.
TEST(LightWalk, ACutDownToTheLeavesHasNoVariance) {
  Random random(14);
  for (const std::size_t n : {1UL, 2UL, 15UL, 16UL, 17UL, 48UL}) {
    const auto lights = random_lights(n, Kind::Mixed, n);
    const LightTree tree(lights);
    const Receiver receiver = random_receiver(random);
    const double exact = light_sum(tree, lights, receiver, 1);
    const Estimate got = estimate(tree, lights, receiver, n, WeightRule::NearAndFar, random);
    EXPECT_NEAR(got.mean, exact, 1e-5 * exact);
    EXPECT_LT(got.standard_error, 1e-5 * exact + 1e-12);
  }
}

// What each rule is worth: relative RMS of one light out of 64 in a cube, the median over receivers
// inside it. Sixteen children at a time must be no worse than two.
TEST(LightWalk, NearAndFarDistancesBeatTheNearOnesAlone) {
  Random random(15);
  std::vector<double> rms[3];
  for (int scene = 0; scene < 60; ++scene) {
    const auto lights = random_lights(64, Kind::Points, 100 + scene);
    const LightTree tree(lights);
    const Receiver receiver{random.in_cube(1.0), random.direction()};
    const double exact = light_sum(tree, lights, receiver, 1);
    if (!(exact > 0.0)) continue;
    double second[3] = {};
    for (NodeId leaf = tree.first_leaf(); leaf < 2 * tree.first_leaf(); ++leaf) {
      const double f = light_sum(tree, lights, receiver, leaf);
      if (f == 0.0) continue;
      const double p[3] = {LightWalk(tree, receiver).probability(1, leaf),
                           test::probability(tree, receiver, 1, leaf, 1),
                           LightWalk(tree, receiver, kRules[1]).probability(1, leaf)};
      for (int k = 0; k < 3; ++k) second[k] += f * f / p[k];
    }
    for (int k = 0; k < 3; ++k) {
      rms[k].push_back(std::sqrt(std::max(second[k] / (exact * exact) - 1.0, 0.0)));
    }
  }
  double median[3];
  for (int k = 0; k < 3; ++k) {
    std::ranges::sort(rms[k]);
    median[k] = rms[k][rms[k].size() / 2];
  }
  RecordProperty("sixteen_children", std::to_string(median[0]));
  RecordProperty("two_children", std::to_string(median[1]));
  RecordProperty("yuksel_2019", std::to_string(median[2]));
  EXPECT_LT(median[0], 1.05 * median[1]);
  EXPECT_LT(median[0], median[2]);
}

// ---- the extremes ----

TEST(LightWalk, NoLightIsNoCut) {
  const LightTree tree;
  LightCut cut;
  const LightWalk walk(tree, {});
  walk.cut(48, cut);
  EXPECT_TRUE(cut.nodes.empty());
}

TEST(LightWalk, CoincidentLightsAreDrawnByTheirIntensity) {
  std::vector<LightBounds> lights;
  for (int i = 1; i <= 40; ++i) lights.push_back(test::point_light({1, 2, 3}, i));
  const LightTree tree(lights);
  // Beside them, and at their very place, where only intensities can tell.
  for (const Vec3& position : {Vec3{1, 1, 3}, Vec3{1, 2, 3}}) {
    const LightWalk walk(tree, {position, {0, 1, 0}});
    double total = 0.0;
    for (NodeId leaf = tree.first_leaf(); tree.light_at(leaf); ++leaf) {
      const double p = walk.probability(1, leaf);
      EXPECT_TRUE(std::isfinite(p));
      total += p;
      if (position.y < 2.0F) {
        EXPECT_NEAR(p, tree.node(leaf).bounds.intensity / 820.0, 1e-5);
      }
    }
    if (position.y < 2.0F) {
      EXPECT_NEAR(total, 1.0, 1e-5);
    }
  }
}

TEST(LightWalk, IntensitiesOfFortyDecadesStayUnbiased) {
  auto lights = random_lights(200, Kind::Points, 16);
  for (std::size_t i = 0; i < lights.size(); ++i) {
    lights[i].intensity = std::pow(10.0, -20.0 + 40.0 * static_cast<double>(i) / 199.0);
  }
  const LightTree tree(lights);
  Random random(17);
  int missed = 0;
  for (int point = 0; point < 32; ++point) {
    const Receiver receiver = random_receiver(random);
    const double exact = light_sum(tree, lights, receiver, 1);
    const Estimate got = estimate(tree, lights, receiver, 4, WeightRule::NearAndFar, random);
    EXPECT_TRUE(std::isfinite(got.mean));
    missed += std::abs(got.mean - exact) > 4.0 * got.standard_error + 1e-5 * exact;
  }
  EXPECT_LE(missed, 1);
}

TEST(LightWalk, ProbabilitiesDoNotDependOnTheScale) {
  const auto lights = random_lights(300, Kind::Mixed, 18);
  const LightTree tree(lights);
  Random random(19);
  for (const float scale : {1e-6F, 1e6F}) {
    auto scaled = lights;
    for (LightBounds& light : scaled) light.centre *= scale, light.half *= scale;
    const LightTree other(scaled);
    ASSERT_TRUE(std::ranges::equal(tree.light_of_leaf(), other.light_of_leaf()));
    for (int i = 0; i < 200; ++i) {
      const Receiver receiver = random_receiver(random);
      const NodeId leaf = tree.first_leaf() + static_cast<NodeId>(random.next() * 300.0);
      const double p = LightWalk(tree, receiver).probability(1, leaf);
      const double q =
          LightWalk(other, {scale * receiver.position, receiver.normal}).probability(1, leaf);
      EXPECT_NEAR(p, q, 0.01 * p + 1e-6);
    }
  }
}

}  // namespace
}  // namespace macula::lights
