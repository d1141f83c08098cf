#include "server/reconstruction/row_warp.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "server/reconstruction/backward_warp.h"

namespace macula::reconstruction {
namespace {

const foveation::Display kScreen{math::symmetric_fov(Degrees{90.0}, 1.0), 203, 150};

Pose turned(double yaw_deg, const DVec3& position) {
  return {position, glm::angleAxis(Radians{Degrees{yaw_deg}}.value(),
                                   DVec3{0.2, 0.9, 0.1} / glm::length(DVec3{0.2, 0.9, 0.1}))};
}

TEST(RowWarp, FindsEveryCellWhereTheScalarWarpDoes) {
  const PixelGrid now = foveation::make_uniform_grid(kScreen);
  const PixelGrid foveal = foveation::make_foveal_grid(kScreen, {}, {});
  const Pose then = turned(3.0, {0.1, 0.02, -0.2});
  for (const PixelGrid& grid : {now, foveal}) {
    const RowWarp warp({}, now, then, grid);
    const BackwardWarp scalar({}, then, grid);
    RowPlaces places;
    std::vector<float> inverse_depth(now.width());
    for (int x = 0; x < now.width(); ++x) inverse_depth[x] = 0.003F * static_cast<float>(x);
    for (int y = 0; y < now.height(); y += 13) {
      warp.row(y, inverse_depth, places);
      for (int x = 0; x < now.width(); ++x) {
        const auto expected = scalar.then(now.tangent(x, y), 1.0F / inverse_depth[x]);
        if (!expected) continue;
        EXPECT_NEAR(places.x[x], expected->cell.x, 0.0625F);
        EXPECT_NEAR(places.y[x], expected->cell.y, 0.0625F);
        EXPECT_NEAR(places.inverse_depth[x], 1.0F / expected->depth_m, 1e-5F);
        const auto one = warp.then(x, y, inverse_depth[x]);
        EXPECT_NEAR(one.x, places.x[x], 1e-3F);
        EXPECT_NEAR(one.inverse_depth, places.inverse_depth[x], 1e-6F);
      }
    }
  }
}

TEST(RowWarp, APureTurnMovesEverythingAlikeHoweverFarItIs) {
  const PixelGrid grid = foveation::make_uniform_grid(kScreen);
  const RowWarp warp({}, grid, turned(5.0, DVec3{0.0}), grid);
  for (const float depth : {0.0F, 0.1F, 10.0F}) {
    EXPECT_NEAR(warp.then(100, 70, depth).x, warp.then(100, 70, 1.0F).x, 1e-4F);
    EXPECT_NEAR(warp.then(100, 70, depth).y, warp.then(100, 70, 1.0F).y, 1e-4F);
  }
}

TEST(RowWarp, WhatLayBehindTheEyeIsToldSo) {
  const PixelGrid grid = foveation::make_uniform_grid(kScreen);
  const RowWarp warp({}, grid, turned(180.0, DVec3{0.0}), grid);
  RowPlaces places;
  warp.row(75, std::vector<float>(grid.width(), 0.0F), places);
  for (const float depth : places.inverse_depth) EXPECT_LT(depth, 0.0F);
}

TEST(RowWarp, DepthsThereAndBackAgree) {
  const PixelGrid grid = foveation::make_uniform_grid(kScreen);
  const RowWarp warp({}, grid, turned(2.0, {0.3, -0.1, 0.4}), grid);
  for (const float depth : {0.0F, 0.05F, 0.5F}) {
    const auto place = warp.then(90, 60, depth);
    const Vec2 tangent = grid.tangent(static_cast<int>(place.x), static_cast<int>(place.y),
                                      place.x - std::floor(place.x), place.y - std::floor(place.y));
    EXPECT_NEAR(warp.inverse_depth_now(tangent, place.inverse_depth), depth, 1e-5F);
  }
}

TEST(AxisLocator, FindsPlacesAsTheGridsOwnSearchDoes) {
  const PixelGrid foveal = foveation::make_foveal_grid(kScreen, {}, {});
  const AxisLocator axis(foveal.x_edges);
  ASSERT_FALSE(axis.equal_steps());
  for (float t = foveal.x_edges.front() + 1e-4F; t < foveal.x_edges.back(); t += 0.0007F) {
    const auto expected = foveal.locate({t, 0.0F});
    ASSERT_TRUE(expected);
    EXPECT_NEAR(axis.locate(t), expected->x, 0.0625F);
  }
  EXPECT_LT(axis.locate(foveal.x_edges.front() - 0.1F), 0.0F);
  EXPECT_GT(axis.locate(foveal.x_edges.back() + 0.1F), static_cast<float>(foveal.width()));
}

}  // namespace
}  // namespace macula::reconstruction
