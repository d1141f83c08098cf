#include <gtest/gtest.h>

#include <limits>

#include "tests/client/reprojection/analytic_scene.h"

namespace macula::reprojection {
namespace {

using namespace test;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

TEST(WarpEdgeCases, ADisplayThatLooksAwaySeesBlackAndSaysSo) {
  const auto display = square_display(80);
  const Frame frame =
      draw(textured_plane({0, 0, 1}, -2.0, 1.0), foveation::make_uniform_grid(display), {});
  for (const Degrees angle : {Degrees{90}, Degrees{180}}) {
    image::Plane<Rgb8> out;
    const WarpReport report =
        warp(frame.view(), {{0, 0, 0}, turn({0, 1, 0}, angle)}, display, {}, out);
    EXPECT_EQ(report.outside_px, 80U * 80U);
    EXPECT_EQ(report.filled_share(), 0.0);
    for (const Rgb8& c : out.pixels()) ASSERT_EQ(c, Rgb8{});
  }
}

TEST(WarpEdgeCases, UnusableDepthsCountAsSky) {
  const auto display = square_display(60);
  const auto scene = textured_plane({0, 0, 1}, -2.0, 1.0);
  Frame sky = draw(scene, grid_with_margin(display, 10), {});
  Frame broken = sky;
  const float bad[] = {kNan, kInf, -kInf, -1.0F, -0.0F};
  for (std::size_t i = 0; i < sky.inverse_depth.size(); i += 3) {
    sky.inverse_depth.data()[i] = 0.0F;
    broken.inverse_depth.data()[i] = bad[i / 3 % 5];
  }
  image::Plane<Rgb8> a, b;
  const Pose pose{{0.05, 0.02, 0.0}, turn({0, 1, 0}, Degrees{3})};
  const WarpReport p = warp(sky.view(), pose, display, {}, a);
  const WarpReport q = warp(broken.view(), pose, display, {}, b);
  EXPECT_EQ(p.covered_px, q.covered_px);
  EXPECT_EQ(psnr_db(a, b, [](int, int) { return true; }), kInfinity);
}

TEST(WarpEdgeCases, ExtremeDepthsAndOffsetsNeverEscapeThePicture) {
  // Run for its memory accesses under the sanitizers as much as for its report.
  const auto display = square_display(40);
  Frame frame =
      draw(textured_plane({0, 0, 1}, -2.0, 1.0), foveation::make_uniform_grid(display), {});
  const float extremes[] = {0.0F, 1e-38F, 1e-6F, 1.0F, 999.0F, 1e30F, 3.4e38F};
  for (std::size_t i = 0; i < frame.inverse_depth.size(); ++i) {
    frame.inverse_depth.data()[i] = extremes[i * 7919 % 7];
  }
  for (const double reach : {1e-9, 0.001, 1.0, 1e3, 1e6}) {
    for (const DVec3& way : {DVec3{1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}) {
      image::Plane<Rgb8> out;
      const WarpReport r =
          warp(frame.view(), {reach * way, turn(way, Degrees{30})}, display, {}, out);
      EXPECT_EQ(r.covered_px + r.filled_px + r.outside_px, 1600U);
    }
  }
}

TEST(WarpEdgeCases, ANonFiniteDisplayPoseLeavesBlack) {
  const auto display = square_display(20);
  const Frame frame =
      draw(textured_plane({0, 0, 1}, -2.0, 1.0), foveation::make_uniform_grid(display), {});
  image::Plane<Rgb8> out;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(warp(frame.view(), {{nan, 0, 0}, {1, 0, 0, 0}}, display, {}, out).covered_px, 0U);
  EXPECT_EQ(warp(frame.view(), {{0, 0, 0}, {nan, 0, 0, 0}}, display, {}, out).covered_px, 0U);
}

TEST(WarpEdgeCases, GeometryTheEyeHasPassedIsNotSeenMirrored) {
  // The eye moves 1.5 m ahead, past a board at 1 m: only the wall at 4 m remains, board pixels open
  // up.
  const auto display = square_display(120);
  const Frame frame = draw(board_before_wall(1.0, 4.0), foveation::make_uniform_grid(display), {});
  image::Plane<Rgb8> out;
  image::Plane<Coverage> coverage;
  const WarpReport report =
      warp(frame.view(), {{0, 0, -1.5}, {1, 0, 0, 0}}, display, {}, out, &coverage);
  EXPECT_GT(report.covered_px, 120U * 50U);
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (coverage.data()[i] != Coverage::Covered) continue;
    ASSERT_LT(out.data()[i].g, 5);
  }
}

TEST(WarpEdgeCases, GeometryAtTheEyeIsClippedNotSpreadOverThePicture) {
  // A wall 5 mm before the display eye is nearer than the near plane of 1 cm.
  const auto display = square_display(40);
  const Frame frame =
      draw(textured_plane({0, 0, 1}, -1.0, 1.0), foveation::make_uniform_grid(display), {});
  image::Plane<Rgb8> out;
  EXPECT_EQ(warp(frame.view(), {{0, 0, -0.995}, {1, 0, 0, 0}}, display, {}, out).covered_px, 0U);
  EXPECT_EQ(warp(frame.view(), {{0, 0, -0.985}, {1, 0, 0, 0}}, display, {}, out).covered_px, 1600U);
}

TEST(WarpEdgeCases, ACeilingSeenAlongItsSurfaceStaysWhole) {
  // Inverse depth changes fast from row to row, but affinely: nothing to cut, nothing to fill.
  const auto display = square_display(200);
  const auto scene = textured_plane({0, 1, 0}, -0.3, 0.5);  // a floor 30 cm below the eye
  const Frame frame = draw(scene, grid_with_margin(display, 40), {});
  image::Plane<Rgb8> out;
  image::Plane<Coverage> coverage;
  warp(frame.view(), {{0.05, 0.05, 0.05}, {1, 0, 0, 0}}, display, {}, out, &coverage);
  // Below the horizon by 5 % of the picture, where the floor's edge to the sky cannot matter.
  int filled = 0;
  for (int y = 110; y < 200; ++y)
    for (int x = 0; x < 200; ++x) filled += coverage(x, y) == Coverage::Covered ? 0 : 1;
  EXPECT_EQ(filled, 0);
}

}  // namespace
}  // namespace macula::reprojection
