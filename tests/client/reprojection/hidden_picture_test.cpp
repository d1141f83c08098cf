#include "client/reprojection/hidden_picture.h"

#include <gtest/gtest.h>

#include "tests/client/reprojection/analytic_scene.h"

namespace macula::reprojection {
namespace {

using namespace test;

constexpr double kBoard_m = 1.0, kWall_m = 3.0;

/// A green board x < 0 before a wall with waves on it.
Sight board_before_waves(const DVec3& origin, const DVec3& direction) {
  const double t_board = (-kBoard_m - origin.z) / direction.z;
  if (origin.x + t_board * direction.x < 0.0) return {t_board, {0.0, 1.0, 0.0}};
  return textured_plane({0, 0, 1}, -kWall_m, 1.5)(origin, direction);
}

/// The frame with what the board hides within `reach` cells of its edge.
struct LayeredFrame {
  Frame frame;
  HiddenPicture hidden;
  SourceView view() const {
    SourceView view = frame.view();
    view.hidden = &hidden;
    return view;
  }
};
LayeredFrame layered_frame(const PixelGrid& grid, int reach) {
  Frame frame = draw(board_before_waves, grid, {}, 3);
  const Frame wall = draw(textured_plane({0, 0, 1}, -kWall_m, 1.5), grid, {}, 3);
  image::Plane<std::uint8_t> band(grid.width(), grid.height());
  for (int y = 0; y < grid.height(); ++y) {
    for (int x = 0; x + reach < grid.width(); ++x) {
      if (grid.tangent(x, y).x < 0.0F && grid.tangent(x + reach, y).x >= 0.0F) band(x, y) = 1;
    }
  }
  HiddenPicture hidden =
      make_hidden_picture(frame.color, frame.inverse_depth, band, wall.color, wall.inverse_depth);
  return {std::move(frame), std::move(hidden)};
}

struct Shown {
  double psnr_db = 0.0;  ///< where the first layer alone has nothing to show
  WarpReport report;
};
/// The eye steps to the right and sees more of the wall.
Shown step_right(WarpOptions::Layers layers) {
  const foveation::Display display = square_display(160);
  const LayeredFrame source = layered_frame(grid_with_margin(display, 20), 12);
  const Pose pose{{0.05, 0.0, 0.0}, DQuat{1, 0, 0, 0}};
  const Frame expected = draw(board_before_waves, foveation::make_uniform_grid(display), pose, 3);
  WarpOptions options;
  options.layers = WarpOptions::Layers::First;
  image::Plane<Rgb8> shown;
  image::Plane<Coverage> uncovered;
  warp(source.view(), pose, display, options, shown, &uncovered);
  options.layers = layers;
  Shown result;
  result.report = warp(source.view(), pose, display, options, shown);
  result.psnr_db = psnr_db(shown, expected.color,
                           [&](int x, int y) { return uncovered(x, y) == Coverage::Filled; });
  return result;
}

TEST(HiddenPicture, ShowsWhatComesIntoSight) {
  const Shown both = step_right(WarpOptions::Layers::Both);
  EXPECT_EQ(both.report.filled_px, 0U);
  EXPECT_GT(both.psnr_db, 38.0);
}

// The twin: the same frame without its second layer must guess.
TEST(HiddenPicture, IsMissedWhereItIsLeftOut) {
  const Shown first = step_right(WarpOptions::Layers::First);
  EXPECT_GT(first.report.filled_px, 300U);
  EXPECT_LT(first.psnr_db, 25.0);
}

TEST(HiddenPicture, ChangesNoBitWhereTheEyeHasNotMoved) {
  const foveation::Display display = square_display(96);
  const LayeredFrame source = layered_frame(grid_with_margin(display, 20), 12);
  const Pose turned{{}, turn({0.1, 1.0, 0.0}, Degrees{3.0})};
  WarpOptions options;
  image::Plane<Rgb8> with, without;
  warp(source.view(), turned, display, options, with);
  options.layers = WarpOptions::Layers::First;
  warp(source.view(), turned, display, options, without);
  EXPECT_TRUE(std::equal(with.pixels().begin(), with.pixels().end(), without.pixels().begin()));
}

TEST(HiddenPicture, NamesTheCellsOfTheMeshThatTouchIt) {
  const image::Plane<Rgb8> color(5, 4);
  const image::Plane<float> depth(5, 4, 0.5F), behind(5, 4, 0.25F);
  image::Plane<std::uint8_t> band(5, 4);
  band(2, 1) = 1;
  const HiddenPicture picture = make_hidden_picture(color, depth, band, color, behind);
  for (int y = 0; y <= 4; ++y) {
    for (int x = 0; x <= 5; ++x) {
      const bool touches = (x == 2 || x == 3) && (y == 1 || y == 2);
      EXPECT_EQ(picture.cells(x, y), touches ? 1 : 0) << x << ", " << y;
    }
  }
  EXPECT_EQ(picture.inverse_depth_per_m(2, 1), 0.25F);
  EXPECT_EQ(picture.inverse_depth_per_m(3, 1), 0.5F);
}

}  // namespace
}  // namespace macula::reprojection
