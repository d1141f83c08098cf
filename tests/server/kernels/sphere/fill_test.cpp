#include "server/kernels/sphere/fill.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace macula::kernels::sphere {
namespace {

/// A middle level over `grid` given by functions of the tangent.
template <class Radiance, class InverseDepth>
MidLevel mid_level(const PixelGrid& mid_grid, Radiance&& radiance, InverseDepth&& inverse_depth) {
  MidLevel mid;
  mid.resize(mid_grid.width(), mid_grid.height());
  for (int y = 0; y < mid_grid.height(); ++y) {
    for (int x = 0; x < mid_grid.width(); ++x) {
      mid.radiance(x, y) = radiance(mid_grid.tangent(x, y));
      mid.inverse_depth(x, y) = inverse_depth(mid_grid.tangent(x, y));
    }
  }
  return mid;
}

ViewBuffers planes_of(const PixelGrid& grid) {
  ViewBuffers planes;
  planes.radiance = Plane<Rgb>(grid.width(), grid.height());
  planes.depth_m = Plane<float>(grid.width(), grid.height());
  return planes;
}

TEST(Fill, WhatIsAffineOverThePictureIsFilledExactly) {
  // Odd sides: the last block is narrower, and its middle lies elsewhere.
  for (const int side : {32, 33}) {
    const PixelGrid grid =
        foveation::make_uniform_grid({math::symmetric_fov(Degrees{60.0}, 1.0), side, side});
    const PixelGrid mid_grid = coarsen(grid, kMidSide);
    const auto colour = [](const Vec2& t) {
      return Rgb{1.0F + 0.5F * t.x, 1.0F - 0.3F * t.y, 1.0F};
    };
    const auto inverse = [](const Vec2& t) { return 0.5F + 0.01F * t.x; };
    ViewBuffers planes = planes_of(grid);
    TileScheduler scheduler(1);
    scheduling::RowBands bands(scheduler, side);
    fill_unimportant(grid, mid_grid, Plane<std::uint8_t>(side, side, 0),
                     mid_level(mid_grid, colour, inverse), 0, bands, planes);
    for (int y = 2; y + 2 < side; ++y) {  // the border repeats its samples
      for (int x = 2; x + 2 < side; ++x) {
        EXPECT_NEAR(planes.radiance(x, y).x, colour(grid.tangent(x, y)).x, 1e-5F);
        EXPECT_NEAR(planes.radiance(x, y).y, colour(grid.tangent(x, y)).y, 1e-5F);
        EXPECT_NEAR(planes.depth_m(x, y), 1.0F / inverse(grid.tangent(x, y)), 1e-4F);
      }
    }
  }
}

TEST(Fill, NoDepthLiesBetweenTwoSurfaces) {
  const PixelGrid grid =
      foveation::make_uniform_grid({math::symmetric_fov(Degrees{60.0}, 1.0), 24, 24});
  const PixelGrid mid_grid = coarsen(grid, kMidSide);
  const MidLevel mid = mid_level(
      mid_grid, [](const Vec2&) { return Rgb{1.0F}; },
      [](const Vec2& t) { return t.x < 0.0F ? 0.5F : (t.y < 0.0F ? 0.1F : 0.0F); });
  ViewBuffers planes = planes_of(grid);
  TileScheduler scheduler(1);
  scheduling::RowBands bands(scheduler, 24);
  fill_unimportant(grid, mid_grid, Plane<std::uint8_t>(24, 24, 0), mid, 0, bands, planes);
  for (const float depth : planes.depth_m.pixels())
    EXPECT_TRUE(std::abs(depth - 2.0F) < 1e-4F || std::abs(depth - 10.0F) < 1e-3F ||
                std::isinf(depth))
        << depth;
}

TEST(Fill, ImportantCellsAreLeftAlone) {
  const PixelGrid grid =
      foveation::make_uniform_grid({math::symmetric_fov(Degrees{60.0}, 1.0), 8, 8});
  ViewBuffers planes = planes_of(grid);
  Plane<std::uint8_t> important(8, 8, 0);
  important(3, 4) = 1;
  planes.radiance(3, 4) = Rgb{7.0F};
  const PixelGrid mid_grid = coarsen(grid, kMidSide);
  TileScheduler scheduler(1);
  scheduling::RowBands bands(scheduler, 8);
  fill_unimportant(
      grid, mid_grid, important,
      mid_level(
          mid_grid, [](const Vec2&) { return Rgb{1.0F}; }, [](const Vec2&) { return 1.0F; }),
      0, bands, planes);
  EXPECT_EQ(planes.radiance(3, 4), Rgb{7.0F});
  EXPECT_EQ(planes.radiance(3, 5), Rgb{1.0F});
}

/// An eye in a solid sees depth 0, whose inverse was infinite: the next frame's averages over it
/// were not numbers.
TEST(Fill, AveragesOfAnEyeInASolidStayFinite) {
  const PixelGrid grid =
      foveation::make_uniform_grid({math::symmetric_fov(Degrees{60.0}, 1.0), 8, 8});
  ViewBuffers planes = planes_of(grid);
  std::ranges::fill(planes.depth_m.pixels(), 0.0F);
  planes.depth_m(4, 4) = std::numeric_limits<float>::infinity();
  planes.depth_m(6, 6) = 2.0F;
  MidLevel mid;
  mid.resize(4, 4);
  std::ranges::fill(mid.source.pixels(), MidSource::Average);
  TileScheduler scheduler(1);
  average_important(planes, 0, scheduler, mid);
  EXPECT_TRUE(std::isfinite(mid.inverse_depth(0, 0)));
  EXPECT_GT(mid.inverse_depth(0, 0), 1e20F);
  EXPECT_EQ(mid.inverse_depth(2, 2), 0.0F);
  EXPECT_EQ(mid.inverse_depth(3, 3), 0.5F);
}

TEST(Fill, BlurTouchesOnlyWhereImportanceChanges) {
  Plane<std::uint8_t> important(16, 16, 0);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 8; ++x) important(x, y) = 1;
  Plane<Rgb> radiance(16, 16, Rgb{0.0F});
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 8; ++x) radiance(x, y) = Rgb{1.0F};
  TileScheduler scheduler(1);
  scheduling::RowBands bands(scheduler, 16);
  soften_transitions(important, bands, radiance);
  EXPECT_EQ(radiance(6, 8), Rgb{1.0F});
  EXPECT_EQ(radiance(7, 8), Rgb{0.75F});
  EXPECT_EQ(radiance(8, 8), Rgb{0.25F});
  EXPECT_EQ(radiance(9, 8), Rgb{0.0F});
}

}  // namespace
}  // namespace macula::kernels::sphere
