#include "server/reconstruction/backward_warp.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace macula::reconstruction {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

PixelGrid raster() {
  return foveation::make_uniform_grid({math::symmetric_fov(Degrees{90.0}, 1.0), 200, 200});
}

TEST(BackwardWarp, AViewThatDidNotMoveFindsEverythingWhereItIs) {
  const PixelGrid grid = raster();
  const Pose pose = math::look_at({1, 2, 3}, {-4, 1, 0}, {0, 1, 0});
  const BackwardWarp warp(pose, pose, grid);
  for (const float depth : {0.1F, 5.0F, 1e4F, kInfinity}) {
    const auto place = warp.then(grid.tangent(17, 150), depth);
    ASSERT_TRUE(place);
    EXPECT_NEAR(place->cell.x, 17.5F, 1e-3F);
    EXPECT_NEAR(place->cell.y, 150.5F, 1e-3F);
    const float ratio = std::isfinite(depth) ? place->depth_m / depth : 1.0F;
    EXPECT_NEAR(ratio, 1.0F, 1e-6F);
  }
}

TEST(BackwardWarp, AStepForwardMovesPointsTowardsTheMiddleByTheRatioOfDepths) {
  // From 1 m behind, a point at depth d lay at depth d + 1 and at d / (d + 1) of its tangent.
  const PixelGrid grid = raster();
  const Pose now{}, then{DVec3{0.0, 0.0, 1.0}, DQuat{1.0, 0.0, 0.0, 0.0}};
  const BackwardWarp warp(now, then, grid);
  const auto place = warp.then({0.5F, -0.25F}, 3.0F);
  ASSERT_TRUE(place);
  EXPECT_FLOAT_EQ(place->depth_m, 4.0F);
  const auto expected = grid.locate({0.5F * 0.75F, -0.25F * 0.75F});
  EXPECT_NEAR(place->cell.x, expected->x, 1e-3F);
  EXPECT_NEAR(place->cell.y, expected->y, 1e-3F);
}

TEST(BackwardWarp, WhatLiesAtInfinityMovesWithTheRotationAlone) {
  const PixelGrid grid = raster();
  const Pose now{};
  Pose then{DVec3{50.0, 0.0, 0.0},
            DQuat{std::cos(0.05), 0.0, std::sin(0.05), 0.0}};  // 0.1 rad left
  const auto place = BackwardWarp(now, then, grid).then({0.0F, 0.0F}, kInfinity);
  ASSERT_TRUE(place);
  EXPECT_NEAR(place->cell.x, grid.locate({std::tan(0.1F), 0.0F})->x, 1e-3F);
  EXPECT_EQ(place->depth_m, kInfinity);
}

TEST(BackwardWarp, WhatLayBehindTheEyeOrOutsideThePictureIsNowhere) {
  const PixelGrid grid = raster();
  const Pose turned{DVec3{0.0}, DQuat{0.0, 0.0, 1.0, 0.0}};  // half a turn
  EXPECT_FALSE(BackwardWarp(Pose{}, turned, grid).then({0.0F, 0.0F}, 2.0F));
  const Pose aside{DVec3{10.0, 0.0, 0.0}, DQuat{1.0, 0.0, 0.0, 0.0}};
  EXPECT_FALSE(BackwardWarp(Pose{}, aside, grid).then({0.0F, 0.0F}, 2.0F));
}

TEST(BackwardWarp, DepthsGoThereAndBack) {
  const PixelGrid grid = raster();
  const Pose now = math::look_at({0, 0, 0}, {0.3, 0.1, -1}, {0, 1, 0});
  const Pose then = math::look_at({0.2, -0.1, 0.4}, {0.1, 0, -1}, {0, 1, 0});
  const BackwardWarp warp(now, then, grid);
  const auto place = warp.then({0.1F, 0.2F}, 2.5F);
  ASSERT_TRUE(place);
  const int x = static_cast<int>(place->cell.x), y = static_cast<int>(place->cell.y);
  const Vec2 tangent = grid.tangent(x, y, place->cell.x - static_cast<float>(x),
                                    place->cell.y - static_cast<float>(y));
  EXPECT_NEAR(warp.depth_now(tangent, place->depth_m), 2.5F, 1e-4F);
}

}  // namespace
}  // namespace macula::reconstruction
