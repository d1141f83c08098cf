#include "server/kernels/sphere/detail.h"

#include <gtest/gtest.h>

#include <limits>

namespace macula::kernels::sphere {
namespace {

constexpr int kBlocks = 8;
constexpr int kCells = kMidSide * kBlocks;

/// Blocks left of column 4 have one radiance, the others another.
MidLevel two_halves(float left, float right) {
  MidLevel mid;
  mid.resize(kBlocks, kBlocks);
  for (int y = 0; y < kBlocks; ++y)
    for (int x = 0; x < kBlocks; ++x) mid.radiance(x, y) = Rgb{x < 4 ? left : right};
  return mid;
}

Detail detail_of(const MidLevel& mid, const Plane<std::uint8_t>& important, float contrast = 0.1F) {
  TileScheduler scheduler(2);
  return find_detail(mid, important, image::Tone{}, contrast, scheduler);
}

int count(const Plane<std::uint8_t>& marks) {
  int sum = 0;
  for (const std::uint8_t mark : marks.pixels()) sum += mark;
  return sum;
}

TEST(Detail, LiesOnBothSidesOfAStepAndNowhereElse) {
  const Plane<std::uint8_t> none(kCells, kCells, 0);
  const Detail detail = detail_of(two_halves(0.25F, 0.49F), none);  // lightness 0.5 and 0.7
  for (int y = 0; y < kCells; ++y)
    for (int x = 0; x < kCells; ++x)
      EXPECT_EQ(detail.cells(x, y), x >= 6 && x < 10 ? 1 : 0) << x << ", " << y;
  for (int x = 0; x < kBlocks; ++x) EXPECT_EQ(detail.blocks(x, 3), x == 3 || x == 4 ? 1 : 0) << x;
}

TEST(Detail, IsAStepBeyondTheContrastAlone) {
  const Plane<std::uint8_t> none(kCells, kCells, 0);
  const MidLevel mid = two_halves(0.25F, 0.49F);
  EXPECT_GT(count(detail_of(mid, none, 0.19F).cells), 0);
  EXPECT_EQ(count(detail_of(mid, none, 0.21F).cells), 0);
  EXPECT_EQ(count(detail_of(mid, none, std::numeric_limits<float>::infinity()).cells), 0);
  // What the display clips shows no step.
  EXPECT_EQ(count(detail_of(two_halves(1.5F, 40.0F), none).cells), 0);
}

TEST(Detail, LeavesImportantCellsToTheFullLevel) {
  Plane<std::uint8_t> important(kCells, kCells, 0);
  important(6, 0) = 1;  // one of four
  for (const auto& [x, y] : {std::pair{8, 2}, {9, 2}, {8, 3}, {9, 3}}) important(x, y) = 1;
  const Detail detail = detail_of(two_halves(0.0F, 1.0F), important);
  EXPECT_EQ(detail.cells(6, 0), 0);
  EXPECT_EQ(detail.cells(7, 0), 1);
  EXPECT_EQ(detail.blocks(3, 0), 1);
  EXPECT_EQ(detail.blocks(4, 1), 0) << "a block that is important whole";
  EXPECT_EQ(count(detail.cells), 4 * kCells - 5);
}

TEST(Detail, CoversTheNarrowBlocksOfOddPictures) {
  MidLevel mid;
  mid.resize(2, 1);
  mid.radiance(1, 0) = Rgb{1.0F};
  const Detail detail = detail_of(mid, Plane<std::uint8_t>(3, 1, 0));
  EXPECT_EQ(count(detail.cells), 3);
  EXPECT_EQ(count(detail.blocks), 2);
}

}  // namespace
}  // namespace macula::kernels::sphere
