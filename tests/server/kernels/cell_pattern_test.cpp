#include "server/kernels/ray/cell_pattern.h"

#include <set>
#include <utility>

#include <gtest/gtest.h>

namespace macula::kernels::ray {
namespace {

const sampling::SampleKey kKey(1, 2, 3);

TEST(CellPattern, OneFixedSampleIsTheCentre) {
  const CellPattern pattern(1, Placement::Fixed);
  EXPECT_EQ(pattern.position(kKey, 0), Vec2{0.5F});
  EXPECT_TRUE(pattern.guide_is_central());
}

TEST(CellPattern, ASquareCountPutsOneSampleIntoEveryPart) {
  for (const Placement placement : {Placement::Fixed, Placement::Jittered}) {
    const CellPattern pattern(9, placement);
    std::set<std::pair<int, int>> parts;
    for (int s = 0; s < 9; ++s) {
      const Vec2 at = pattern.position(kKey, s);
      parts.emplace(static_cast<int>(at.x * 3.0F), static_cast<int>(at.y * 3.0F));
    }
    EXPECT_EQ(parts.size(), 9U);
  }
  EXPECT_EQ(CellPattern(9, Placement::Fixed).guide(), 4);
  EXPECT_FALSE(CellPattern(9, Placement::Jittered).guide_is_central());
  EXPECT_FALSE(CellPattern(4, Placement::Fixed).guide_is_central());
}

TEST(CellPattern, JitteredSamplesCoverTheCellEvenlyOverManyCells) {
  for (const int count : {1, 3, 4}) {
    const CellPattern pattern(count, Placement::Jittered);
    DVec2 sum{0.0};
    constexpr int kCellCount = 20000;
    for (int cell = 0; cell < kCellCount; ++cell) {
      const sampling::SampleKey key(1, 0, static_cast<std::uint64_t>(cell));
      for (int s = 0; s < count; ++s) sum += DVec2(pattern.position(key, s));
    }
    // Standard error of a uniform mean: sqrt(1 / 12 / 20000) = 0.002.
    EXPECT_NEAR(sum.x / (kCellCount * count), 0.5, 0.009);
    EXPECT_NEAR(sum.y / (kCellCount * count), 0.5, 0.009);
  }
}

}  // namespace
}  // namespace macula::kernels::ray
