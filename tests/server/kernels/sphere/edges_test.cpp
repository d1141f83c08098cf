#include "server/kernels/sphere/edges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/kernels/sphere/levels.h"

namespace macula::kernels::sphere {
namespace {

PixelGrid raster(int side_px) {
  return foveation::make_uniform_grid({math::symmetric_fov(Degrees{90.0}, 1.0), side_px, side_px});
}

/// The low level of a scene given by view depth over the tangent plane.
template <class Depth>
LowLevel low_level(const PixelGrid& grid, Depth&& depth) {
  LowLevel low;
  low.inverse_depth = Plane<float>(grid.width(), grid.height());
  low.distance = low.inverse_depth;
  for (int y = 0; y < grid.height(); ++y) {
    for (int x = 0; x < grid.width(); ++x) {
      const float z = depth(grid.tangent(x, y));
      low.inverse_depth(x, y) = 1.0F / z;
      low.distance(x, y) = z * glm::length(grid.ray(x, y));
    }
  }
  return low;
}

int count(const Plane<float>& edges) {
  return static_cast<int>(std::ranges::count(edges.pixels(), 1.0F));
}

/// A floor 1.6 m below the eye under nothing: depth 1.6 / y below the horizon.
float floor_depth(const Vec2& tangent) {
  return tangent.y > 0.0F ? 1.6F / tangent.y : std::numeric_limits<float>::infinity();
}

TEST(Edges, ASlantedPlaneHasNone) {
  // 1/z = (1 + 0.8 x - 0.6 y) / 3 over the plane: as slanted as one can be seen.
  const PixelGrid grid = raster(64);
  const LowLevel low =
      low_level(grid, [](const Vec2& t) { return 3.0F / (1.0F + 0.4F * t.x - 0.3F * t.y); });
  EXPECT_EQ(count(find_edges(low, grid, MaskConfig{})), 0);
}

TEST(Edges, ThePapersFilterFiresAllOverAFloor) {
  const PixelGrid grid = raster(64);
  const LowLevel low = low_level(grid, floor_depth);
  MaskConfig literal;
  literal.rule = MaskRule::Literal;
  // Only the horizon's own cells and their neighbours are edges of the corrected measure.
  EXPECT_LE(count(find_edges(low, grid, MaskConfig{})), 4 * 64);
  EXPECT_GT(count(find_edges(low, grid, literal)), 10 * 64);
}

TEST(Edges, ASilhouetteAndACreaseAreSeenAndWidenedByOneCell) {
  const PixelGrid grid = raster(64);
  const LowLevel step = low_level(grid, [](const Vec2& t) { return t.x < 0.0F ? 2.0F : 3.0F; });
  const Plane<float> edges = find_edges(step, grid, MaskConfig{});
  for (int x = 0; x < 64; ++x)
    EXPECT_EQ(edges(x, 30), x >= 30 && x <= 33 ? 1.0F : 0.0F) << "column " << x;
  const LowLevel crease =
      low_level(grid, [](const Vec2& t) { return 3.0F / (1.0F + 2.0F * std::abs(t.x)); });
  EXPECT_EQ(find_edges(crease, grid, MaskConfig{})(32, 10), 1.0F);
}

TEST(Edges, DoNotDependOnTheUnitOfLength) {
  const PixelGrid grid = raster(48);
  const auto ball = [](float scale) {
    return [scale](const Vec2& t) {
      return scale * (glm::dot(t, t) < 0.2F ? 3.0F - std::sqrt(0.2F - glm::dot(t, t)) : 8.0F);
    };
  };
  const Plane<float> meters = find_edges(low_level(grid, ball(1.0F)), grid, MaskConfig{});
  const Plane<float> tiny = find_edges(low_level(grid, ball(1e-6F)), grid, MaskConfig{});
  EXPECT_TRUE(std::ranges::equal(meters.pixels(), tiny.pixels()));
  EXPECT_GT(count(meters), 0);
}

TEST(Edges, UnequalStepsOfAFovealGridMakeNone) {
  const PixelGrid foveal = foveation::make_foveal_grid(
      {math::symmetric_fov(Degrees{90.0}, 1.0), 800, 800}, Gaze{}, foveation::RateModel{});
  const PixelGrid low_grid = coarsen(foveal, kLowSide);
  const LowLevel low =
      low_level(low_grid, [](const Vec2& t) { return 3.0F / (1.0F + 0.4F * t.x - 0.3F * t.y); });
  EXPECT_EQ(count(find_edges(low, low_grid, MaskConfig{})), 0);
}

TEST(Edges, LuminanceCountsWhereItIsGiven) {
  const PixelGrid grid = raster(32);
  LowLevel low = low_level(grid, [](const Vec2&) { return 2.0F; });
  EXPECT_EQ(count(find_edges(low, grid, MaskConfig{})), 0);
  low.luminance = Plane<float>(32, 32, 0.2F);
  for (int y = 0; y < 32; ++y)
    for (int x = 16; x < 32; ++x) low.luminance(x, y) = 0.7F;
  const Plane<float> edges = find_edges(low, grid, MaskConfig{});
  EXPECT_EQ(edges(16, 5), 1.0F);
  EXPECT_EQ(edges(4, 5), 0.0F);
}

TEST(Edges, PicturesOfOneCellHaveNone) {
  for (const int side : {1, 2}) {
    const PixelGrid grid = raster(side);
    EXPECT_EQ(
        count(find_edges(low_level(grid, [](const Vec2&) { return 2.0F; }), grid, MaskConfig{})),
        0);
  }
}

TEST(Levels, KeepEveryFourthEdgeAndTheLast) {
  const PixelGrid low = coarsen({{0, 1, 2, 3, 4, 5, 6}, {0, 1, 2}}, kLowSide);
  EXPECT_EQ(low.x_edges, (std::vector<float>{0, 4, 6}));
  EXPECT_EQ(low.y_edges, (std::vector<float>{0, 2}));
}

}  // namespace
}  // namespace macula::kernels::sphere
