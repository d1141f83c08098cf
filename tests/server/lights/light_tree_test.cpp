// T-TREE-1 and T-TREE-2: what a tree holds.
#include "server/lights/light_tree.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include "tests/server/lights/tree_oracle.h"

namespace macula::lights {
namespace {

using test::Kind;
using test::random_lights;

std::vector<std::size_t> sizes() {
  std::vector<std::size_t> all{0, 1, 2, 3};
  for (int k = 2; k <= 17; k += k < 8 ? 1 : 3) {
    const std::size_t n = std::size_t{1} << k;
    all.insert(all.end(), {n - 1, n, n + 1});
  }
  return all;
}

TEST(LightTree, HoldsEachLightInExactlyOneLeaf) {
  LightTree tree;  // built again and again: nothing of the last one may stay
  for (const std::size_t n : sizes()) {
    tree.build(random_lights(n, Kind::Mixed, n));
    ASSERT_EQ(tree.light_count(), n);
    ASSERT_EQ(tree.first_leaf(), std::bit_ceil(std::max<std::size_t>(n, 1)));
    std::vector<int> seen(n);
    for (NodeId leaf = tree.first_leaf(); leaf < 2 * tree.first_leaf(); ++leaf) {
      const auto light = tree.light_at(leaf);
      EXPECT_EQ(light.has_value(), !tree.node(leaf).empty);
      if (light) ++seen[*light];
    }
    EXPECT_EQ(std::ranges::count(seen, 1), static_cast<std::ptrdiff_t>(n));
  }
}

TEST(LightTree, EveryIntensityIsTheSumOfItsChildren) {
  for (const std::size_t n : sizes()) {
    const LightTree tree(random_lights(n, Kind::Points, n));
    for (NodeId node = 1; node < tree.first_leaf(); ++node) {
      double sum = 0.0;
      for (const NodeId child : {2 * node, 2 * node + 1}) {
        if (!tree.node(child).empty) sum += tree.node(child).bounds.intensity;
      }
      const NodeBounds bounds = tree.node(node);
      EXPECT_EQ(bounds.empty, sum == 0.0);
      if (!bounds.empty) {
        EXPECT_NEAR(bounds.bounds.intensity / sum, 1.0, 1e-12);
      }
    }
  }
}

/// By how much `inner`, bounds of some light below, reaches out of `outer`; boxes in meters.
double box_excess(const LightBounds& outer, const LightBounds& inner) {
  const DVec3 high = DVec3(inner.centre) + DVec3(inner.half) - DVec3(outer.centre);
  const DVec3 low = DVec3(outer.centre) - (DVec3(inner.centre) - DVec3(inner.half));
  const DVec3 excess = glm::max(high, low) - DVec3(outer.half);
  return std::max({excess.x, excess.y, excess.z});
}
double cone_excess(const LightBounds& outer, const LightBounds& inner) {
  if (outer.shines_everywhere()) return 0.0;
  return test::angle_between(DVec3(outer.axis), DVec3(inner.axis)) + test::cone_of(inner) -
         test::cone_of(outer);
}

TEST(LightTree, EveryBoxAndConeHoldsTheLightsBelow) {
  for (const Kind kind : {Kind::Points, Kind::Patches, Kind::Mixed}) {
    for (const std::size_t n : {1UL, 2UL, 5UL, 31UL, 257UL, 4000UL}) {
      const auto lights = random_lights(n, kind, n);
      const LightTree tree(lights);
      double worst_box = -1.0, worst_cone = -1.0;
      for (NodeId leaf = tree.first_leaf(); tree.light_at(leaf); ++leaf) {
        const LightBounds& light = lights[*tree.light_at(leaf)];
        for (NodeId node = leaf; node > 0; node /= 2) {
          const LightBounds bounds = tree.node(node).bounds;
          worst_box = std::max(worst_box, box_excess(bounds, light));
          worst_cone = std::max(worst_cone, cone_excess(bounds, light));
        }
      }
      EXPECT_LE(worst_box, 0.0) << n;
      EXPECT_LE(worst_cone, 1e-4) << n;
    }
  }
}

// Lamps that all shine about the same way: cones must not grow to everything.
TEST(LightTree, BoxesAndConesAreTight) {
  auto lights = random_lights(1000, Kind::Patches, 3);
  test::Random random(4);
  for (LightBounds& light : lights) {
    light.axis = glm::normalize(Vec3{0.0F, -1.0F, 0.0F} + 0.3F * random.direction());
  }
  const LightTree tree(lights);
  const LightBounds root = tree.node(1).bounds;
  EXPECT_LT(test::cone_of(root), 0.55);  // asin 0.3 = 0.305 holds them all; ten unions widen it
  EXPECT_LT(glm::length(root.half), 1.02 * std::sqrt(3.0));
  EXPECT_FLOAT_EQ(root.cos_emission, 0.0F);
}

TEST(LightTree, TheSmallestConeAboutTwoOppositeLightsIsEverything) {
  const LightTree tree(std::vector{test::patch_light({0, 0, 0}, {0, 0, 1}),
                                   test::patch_light({1, 0, 0}, {0, 0, -1})});
  EXPECT_TRUE(tree.node(1).bounds.shines_everywhere());
  const LightTree alike(std::vector(8, test::patch_light({0, 0, 0}, {0.6F, 0.0F, 0.8F})));
  EXPECT_LT(test::cone_of(alike.node(1).bounds), 1e-5);
}

TEST(LightTree, LeafRangesAndDistancesAreThoseCountedOneByOne) {
  for (const std::size_t n : {1UL, 2UL, 64UL, 3000UL}) {
    const LightTree tree(random_lights(n, Kind::Points, n));
    std::vector<LeafRange> counted(2 * tree.first_leaf(), {~NodeId{0}, 0});
    for (NodeId leaf = tree.first_leaf(); leaf < 2 * tree.first_leaf(); ++leaf) {
      for (NodeId node = leaf; node > 0; node /= 2) {
        counted[node].first = std::min(counted[node].first, leaf);
        counted[node].last = std::max(counted[node].last, leaf);
      }
    }
    for (NodeId node = 1; node < 2 * tree.first_leaf(); ++node) {
      EXPECT_EQ(tree.leaves(node).first, counted[node].first);
      EXPECT_EQ(tree.leaves(node).last, counted[node].last);
    }
  }
  const auto walked = [](NodeId a, NodeId b) {
    int steps = 0;
    for (; a != b; ++steps) (a > b ? a : b) /= 2;
    return steps;
  };
  for (NodeId a = 1; a < 256; ++a) {
    for (NodeId b = 1; b < 256; ++b)
      ASSERT_EQ(distance_between(a, b), walked(a, b)) << a << ' ' << b;
  }
}

TEST(LightTree, ATreeScaledByAPowerOfTwoIsTheSameTree) {
  const auto lights = random_lights(500, Kind::Mixed, 9);
  const LightTree tree(lights);
  for (const double scale : {0x1p-20, 0x1p20}) {
    auto scaled = lights;
    for (LightBounds& light : scaled) {
      light.centre *= static_cast<float>(scale), light.half *= static_cast<float>(scale);
    }
    const LightTree other(scaled);
    EXPECT_TRUE(std::ranges::equal(tree.light_of_leaf(), other.light_of_leaf()));
    EXPECT_NEAR(other.radius_m() / (tree.radius_m() * scale), 1.0, 1e-6);
  }
}

// 7.2: intensities from 1e-20 to 1e20.
TEST(LightTree, IntensitiesOfFortyDecadesAddUp) {
  auto lights = random_lights(200, Kind::Points, 5);
  double sum = 0.0;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    lights[i].intensity = std::pow(10.0, -20.0 + 40.0 * static_cast<double>(i) / 199.0);
    sum += lights[i].intensity;
  }
  const LightTree tree(lights);
  EXPECT_NEAR(tree.node(1).bounds.intensity / sum, 1.0, 1e-6);
  for (NodeId leaf = tree.first_leaf(); tree.light_at(leaf); ++leaf) {
    EXPECT_FALSE(tree.node(leaf).empty) << "the dimmest light is still there";
  }
}

/// Whatever vectors a processor has: the same order and sums, boxes up to rounding.
TEST(LightTree, EveryInstructionSetMakesTheSameTree) {
  const auto lights = random_lights(5000, Kind::Mixed, 12);
  const LightTree best(lights);
  const std::int64_t here = hwy::SupportedTargets();
  int sets = 0;
  for (std::int64_t rest = here; rest != 0; rest &= rest - 1) {
    hwy::SetSupportedTargetsForTest(rest & -rest);
    const LightTree tree(lights);
    hwy::SetSupportedTargetsForTest(0);
    ++sets;
    ASSERT_TRUE(std::ranges::equal(tree.light_of_leaf(), best.light_of_leaf()));
    for (NodeId node = 1; node < 2 * best.first_leaf(); ++node) {
      const NodeBounds a = tree.node(node), b = best.node(node);
      ASSERT_EQ(a.empty, b.empty);
      ASSERT_EQ(a.bounds.intensity, b.bounds.intensity);
      ASSERT_LT(glm::distance(a.bounds.centre, b.bounds.centre), 1e-6F);
      ASSERT_LT(glm::distance(a.bounds.half, b.bounds.half), 2e-6F);
    }
  }
  EXPECT_GE(sets, 1);
}

}  // namespace
}  // namespace macula::lights
