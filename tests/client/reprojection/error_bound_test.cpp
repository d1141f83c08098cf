#include "client/reprojection/error_bound.h"

#include <gtest/gtest.h>

#include "shared/math/hash.h"
#include "tests/client/reprojection/analytic_scene.h"

namespace macula::reprojection {
namespace {

using namespace test;

const foveation::Display kDisplay = square_display(96);
/// 2 degrees and 4 cm: what 100 ms of a quick head leave.
const Pose kMoved{{0.03, -0.01, 0.025}, turn({0.2, 1.0, 0.1}, Degrees{2.0})};

/// A frame whose depth is off by up to `residual` (1/m), and which says so in steps of a sixteenth.
struct StatedFrame {
  Frame frame;
  std::vector<std::uint8_t> blocks;
  float step_per_m;
  DepthResidual residual() const { return {blocks, step_per_m}; }
};
StatedFrame stated_frame(const AnalyticScene& scene, float residual) {
  StatedFrame stated{draw(scene, grid_with_margin(kDisplay, 8), {}), {}, residual / 16.0F};
  for (std::size_t i = 0; i < stated.frame.inverse_depth.size(); ++i) {
    const float off = 2.0F * math::unit_float(math::hash_mix(i)) - 1.0F;
    stated.frame.inverse_depth.data()[i] += residual * off;
  }
  const int side = (kDisplay.width_px + 16 + 7) / 8;
  stated.blocks.assign(static_cast<std::size_t>(side * side), 16);
  return stated;
}

/// Points that lie beyond `share` of their bound: many in every cell, where rays of their own hit.
int points_beyond(const AnalyticScene& scene, const StatedFrame& stated, double share) {
  const SourceView view = stated.frame.view();
  const ErrorBound bound(view, stated.residual(), kMoved, kDisplay, {});
  int beyond = 0;
  for (int y = 0; y < view.grid.height(); ++y) {
    for (int x = 0; x < view.grid.width(); ++x) {
      const DVec2 shown = bound.place(x, y, 0.5, 0.5, view.inverse_depth_per_m(x, y));
      for (int i = 0; i < 16; ++i) {
        const double fx = (i % 4 + 0.5) / 4.0, fy = (i / 4 + 0.5) / 4.0;
        const DVec2 tangent(
            view.grid.tangent(x, y, static_cast<float>(fx), static_cast<float>(fy)));
        const Sight sight = scene({}, math::direction_from_tangent(tangent));
        const double error = glm::distance(bound.place(x, y, fx, fy, 1.0 / sight.t), shown);
        if (error > share * bound.at(x, y)) ++beyond;
      }
    }
  }
  return beyond;
}

TEST(ErrorBound, HoldsForEveryPointOfASlantedWall) {
  const auto wall = textured_plane(glm::normalize(DVec3{0.5, 0.2, 1.0}), -1.5, 1.0);
  EXPECT_EQ(points_beyond(wall, stated_frame(wall, 0.02F), 1.0), 0);
}

TEST(ErrorBound, HoldsWhereAnotherSurfaceBegins) {
  const auto board = board_before_wall(0.8, 4.0);
  EXPECT_EQ(points_beyond(board, stated_frame(board, 1e-4F), 1.0), 0);
}

// The twin: half the bound is too little.
TEST(ErrorBound, IsNotWideByAFactorOfTwo) {
  const auto wall = textured_plane({0, 0, 1}, -1.0, 1.0);
  EXPECT_GT(points_beyond(wall, stated_frame(wall, 0.02F), 0.5), 1000);
}

// The twin: a frame that keeps silent about its depth's error.
TEST(ErrorBound, NeedsTheResidual) {
  const auto wall = textured_plane({0, 0, 1}, -1.0, 1.0);
  StatedFrame silent = stated_frame(wall, 0.0F);
  for (float& inverse : silent.frame.inverse_depth.pixels())
    inverse += 0.5F;  // all alike: no steps
  EXPECT_GT(points_beyond(wall, silent, 1.0), 1000);
}

TEST(ErrorBound, IsInfiniteWhereTheFrameBoundsNothing) {
  const auto wall = textured_plane({0, 0, 1}, -1.0, 1.0);
  StatedFrame stated = stated_frame(wall, 0.01F);
  stated.blocks[0] = 255;
  const SourceView view = stated.frame.view();
  const ErrorBound bound(view, stated.residual(), kMoved, kDisplay, {});
  EXPECT_TRUE(std::isinf(bound.at(3, 3)));
  EXPECT_FALSE(std::isinf(bound.at(9, 3)));
}

TEST(ErrorBound, IsHalfACellsDiagonalWhereNothingHasMoved) {
  const auto wall = textured_plane({0, 0, 1}, -1.0, 1.0);
  const StatedFrame stated = stated_frame(wall, 0.01F);
  const SourceView view = stated.frame.view();
  const auto summary =
      ErrorBound(view, stated.residual(), view.stage_from_view, kDisplay, {}).summarise();
  EXPECT_NEAR(summary.p50_px, std::sqrt(0.5), 0.03);
  EXPECT_NEAR(summary.most_px, std::sqrt(0.5), 0.03);
}

TEST(ErrorBound, GrowsWithWhatIsNotKnownOfThePose) {
  const auto wall = textured_plane({0, 0, 1}, -1.0, 1.0);
  const StatedFrame stated = stated_frame(wall, 0.001F);
  const SourceView view = stated.frame.view();
  const auto p50 = [&](const PoseDoubt& doubt) {
    return ErrorBound(view, stated.residual(), kMoved, kDisplay, {}, doubt).summarise().p50_px;
  };
  const double per_tangent = 1.0 / kDisplay.pixel_tangent().x;  // more beside the axis
  EXPECT_NEAR(p50({0.0, Radians{0.01}}) - p50({}), 0.01 * per_tangent, 0.3 * 0.01 * per_tangent);
  EXPECT_NEAR(p50({0.01, Radians{0.0}}) - p50({}), 0.01 * per_tangent, 0.3 * 0.01 * per_tangent);
}

}  // namespace
}  // namespace macula::reprojection
