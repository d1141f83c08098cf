#include "server/kernels/ray/support.h"

#include <gtest/gtest.h>

namespace macula::kernels::ray {
namespace {

PixelGrid raster(int width, int height) {
  return foveation::make_uniform_grid({math::symmetric_fov(Degrees{80.0}, 1.0), width, height});
}

/// The samples of a frame that traces every cell, at these depths, without normals.
FreshSamples all_traced(const Plane<float>& depth_m) {
  std::vector<image::Pixel> cells;
  for (int y = 0; y < depth_m.height(); ++y) {
    for (int x = 0; x < depth_m.width(); ++x) cells.push_back({x, y});
  }
  FreshSamples fresh;
  fresh.prepare(depth_m.width(), depth_m.height(), kNormal, cells.size());
  fresh.place(cells);
  for (const auto& [x, y] : cells) fresh.planes().depth_m.data()[fresh.at(x, y)] = depth_m(x, y);
  return fresh;
}

TEST(Support, OfADk2EyeHasThePapersSize) {
  const Support support(raster(1182, 1464), FoveatedConfig{}.support_spacing);
  EXPECT_NEAR(support.x.count(), 256, 1);
  EXPECT_NEAR(support.y.count(), 318, 1);
  EXPECT_EQ(support.x.cells.front(), 2);
  EXPECT_LT(support.x.cells.back(), 1182);
}

TEST(Support, PicturesOfASingleCellOrRowAreLegal) {
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{1, 37}, std::pair{3, 2}}) {
    const PixelGrid grid = raster(width, height);
    Support support(grid, 4.61F);
    support.fill(all_traced(Plane<float>(width, height, 2.0F)), {});
    std::vector<float> row(width);
    support.inverse_depth_row(height - 1, row);
    for (const float value : row) EXPECT_FLOAT_EQ(value, 0.5F);
  }
}

// The inverse depth of a plane is linear on the tangent plane, on any grid.
TEST(Support, APlaneIsKnownExactlyBetweenItsSamples) {
  const foveation::Display screen{math::symmetric_fov(Degrees{80.0}, 1.0), 200, 200};
  const PixelGrid foveal = foveation::make_foveal_grid(screen, {}, {});
  const auto inverse_depth = [](const Vec2& t) { return 0.4F + 0.1F * t.x - 0.2F * t.y; };
  for (const PixelGrid& grid : {foveation::make_uniform_grid(screen), foveal}) {
    Support support(grid, 4.61F);
    Plane<float> depth_m(grid.width(), grid.height());
    for (int y = 0; y < grid.height(); ++y) {
      for (int x = 0; x < grid.width(); ++x) {
        depth_m(x, y) = 1.0F / inverse_depth(grid.tangent(x, y));
      }
    }
    support.fill(all_traced(depth_m), {});
    std::vector<float> row(grid.width());
    for (int y = 0; y < grid.height(); ++y) {
      support.inverse_depth_row(y, row);
      for (int x = 0; x < grid.width(); ++x) {
        EXPECT_NEAR(row[x], inverse_depth(grid.tangent(x, y)), 1e-5F);
        EXPECT_FALSE(support.broken_at(x, y));
      }
    }
  }
}

TEST(Support, AStepOfDepthBreaksTheQuadsAcrossItAndNoOthers) {
  const PixelGrid grid = raster(100, 100);
  Support support(grid, 5.0F);
  Plane<float> depth_m(100, 100);
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 100; ++x) depth_m(x, y) = x < 50 ? 2.0F : 3.0F;
  }
  support.fill(all_traced(depth_m), {});
  for (int x = 0; x < 100; ++x) {
    const bool across =
        support.x.cells[support.x.left[x]] < 50 && support.x.cells[support.x.right(x)] >= 50;
    EXPECT_EQ(support.broken_at(x, 40), across) << x;
  }
}

}  // namespace
}  // namespace macula::kernels::ray
