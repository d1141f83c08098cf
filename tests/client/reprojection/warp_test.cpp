#include "client/reprojection/warp.h"

#include <gtest/gtest.h>

#include "shared/math/hash.h"
#include "tests/client/reprojection/analytic_scene.h"

namespace macula::reprojection {
namespace {

using namespace test;

struct Warped {
  image::Plane<Rgb8> color;
  image::Plane<Coverage> coverage;
  WarpReport report;
};
Warped warp_to(const Frame& frame, const Pose& pose, const foveation::Display& display,
               const WarpOptions& options = {}) {
  Warped warped;
  warped.report = warp(frame.view(), pose, display, options, warped.color, &warped.coverage);
  return warped;
}
double psnr_where_covered(const Warped& warped, const image::Plane<Rgb8>& expected) {
  return psnr_db(warped.color, expected,
                 [&](int x, int y) { return warped.coverage(x, y) != Coverage::Outside; });
}

/// Colours and depths without any order: the hardest case for exactness.
Frame noise_frame(const foveation::Display& display) {
  Frame frame{{{0.3, 1.6, -2.0}, turn({1, 2, 3}, Degrees{40})},
              foveation::make_uniform_grid(display),
              image::Plane<Rgb8>(display.width_px, display.height_px),
              image::Plane<float>(display.width_px, display.height_px)};
  for (std::size_t i = 0; i < frame.color.size(); ++i) {
    const std::uint64_t h = math::hash_mix(i);
    frame.color.data()[i] = {static_cast<std::uint8_t>(h), static_cast<std::uint8_t>(h >> 8),
                             static_cast<std::uint8_t>(h >> 16)};
    frame.inverse_depth.data()[i] = h % 7 == 0 ? 0.0F : 3.0F * math::unit_float(h);
  }
  return frame;
}

TEST(Warp, TheSamePoseOnTheDisplaysOwnGridReproducesEveryBit) {
  for (const int side : {1, 2, 17, 200}) {
    const auto display = square_display(side);
    const Frame frame = noise_frame(display);
    for (const WarpOptions& options :
         {WarpOptions{}, WarpOptions{.method = WarpOptions::Method::RotationOnly},
          WarpOptions{.method = WarpOptions::Method::Stale},
          WarpOptions{.filter = WarpOptions::Filter::Bilinear}}) {
      const Warped warped = warp_to(frame, frame.stage_from_view, display, options);
      EXPECT_EQ(warped.report.covered_px, frame.color.size());
      for (std::size_t i = 0; i < frame.color.size(); ++i) {
        ASSERT_EQ(warped.color.data()[i], frame.color.data()[i]) << side << " px, pixel " << i;
      }
    }
  }
}

TEST(Warp, AMarginAroundTheDisplayChangesNothingAtTheSamePose) {
  const auto display = square_display(60);
  const auto scene = textured_plane({0, 0, 1}, -1.5, 1.0);
  const Frame plain = draw(scene, foveation::make_uniform_grid(display), {});
  const Frame wide = draw(scene, grid_with_margin(display, 12), {});
  EXPECT_EQ(psnr_where_covered(warp_to(wide, {}, display), plain.color), kInfinity);
}

TEST(Warp, ATurnMovesACheckerAtInfinityByLessThanATenthOfAPixel) {
  // The centroid of a bright disc on black, 4 degrees wide, at infinity: compare with where the
  // disc is.
  const auto display = square_display(300);
  const DVec3 towards = glm::normalize(DVec3{0.1, -0.05, -1.0});
  const AnalyticScene disc = [&](const DVec3&, const DVec3& d) -> Sight {
    return {kInfinity, DVec3(glm::dot(glm::normalize(d), towards) > std::cos(0.035) ? 1.0 : 0.0)};
  };
  const auto centroid = [](const image::Plane<Rgb8>& picture) {
    DVec3 sum{0.0};
    for (int y = 0; y < picture.height(); ++y)
      for (int x = 0; x < picture.width(); ++x)
        sum += static_cast<double>(picture(x, y).g) * DVec3(x, y, 1);
    return DVec2(sum) / sum.z;
  };
  const PixelGrid grid = grid_with_margin(display, 60);
  const Frame frame = draw(disc, grid, {}, 3);
  for (const DVec3& axis : {DVec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, -2, 1}}) {
    const Pose pose{{0.3, 0.0, 0.1}, turn(axis, Degrees{7})};  // offsets do not move infinity
    const Frame expected = draw(disc, foveation::make_uniform_grid(display), pose, 3);
    const Warped warped = warp_to(frame, pose, display);
    EXPECT_LT(glm::distance(centroid(warped.color), centroid(expected.color)), 0.1);
    EXPECT_EQ(warped.report.filled_px, 0U);
  }
}

TEST(Warp, TranslationBeforeASlantedPlaneShowsWhatTheEyeWouldSee) {
  const auto display = square_display(300);
  const auto scene = textured_plane(glm::normalize(DVec3{0.5, 0.2, 1.0}), -1.0, 2.0);
  const Frame frame = draw(scene, grid_with_margin(display, 60), {});
  for (const DVec3& offset :
       {DVec3{0.05, 0, 0}, {0, 0.05, 0}, {0, 0, -0.05}, {-0.03, 0.03, 0.03}}) {
    const Pose pose{offset, turn({0, 1, 0}, Degrees{2})};
    const Frame expected = draw(scene, foveation::make_uniform_grid(display), pose);
    const Warped warped = warp_to(frame, pose, display);
    EXPECT_EQ(warped.report.filled_px, 0U) << "a plane has nothing to uncover";
    EXPECT_EQ(warped.report.outside_px, 0U);
    EXPECT_GT(psnr_where_covered(warped, expected.color), 45.0);
    const Warped turned =
        warp_to(frame, pose, display, {.method = WarpOptions::Method::RotationOnly});
    EXPECT_LT(psnr_where_covered(turned, expected.color), 30.0);  // the twin without depth
    const Warped stale = warp_to(frame, pose, display, {.method = WarpOptions::Method::Stale});
    EXPECT_LT(psnr_where_covered(stale, expected.color), 30.0);
  }
}

TEST(Warp, CatmullRomKeepsTheDetailThatBilinearBlurs) {
  // Waves of 7.5 pixels, moved by half a pixel sideways, where a linear filter is at its worst.
  const auto display = square_display(200);
  const double f_px = 1.0 / display.pixel_tangent().x;
  const auto scene = textured_plane({0, 0, 1}, -1.0, f_px / 7.5);
  const Frame frame = draw(scene, grid_with_margin(display, 10), {});
  const Pose pose{{0.5 / f_px, 0, 0}, {1, 0, 0, 0}};
  const Frame expected = draw(scene, foveation::make_uniform_grid(display), pose);
  const auto psnr = [&](WarpOptions::Filter filter) {
    return psnr_where_covered(warp_to(frame, pose, display, {.filter = filter}), expected.color);
  };
  EXPECT_GT(psnr(WarpOptions::Filter::CatmullRom), psnr(WarpOptions::Filter::Bilinear) + 4.0);
}

TEST(Warp, ACoarseNonUniformGridIsInterpolatedBetweenItsCentres) {
  // Cells 1 to 4 pixels wide; the texture is slow enough for the widest.
  const auto display = square_display(240);
  const PixelGrid fine = grid_with_margin(display, 48);
  PixelGrid grid;
  const auto thin_out = [](const std::vector<float>& edges) {
    std::vector<float> kept;
    for (std::size_t i = 0; i < edges.size(); i += i < 80 || i > 240 ? 4 : 1)
      kept.push_back(edges[i]);
    return kept;
  };
  grid.x_edges = thin_out(fine.x_edges), grid.y_edges = thin_out(fine.y_edges);
  const auto scene = textured_plane({0, 0, 1}, -1.0, 1.0);
  const Pose pose{{0.04, -0.02, 0.0}, turn({1, 1, 0}, Degrees{3})};
  const Frame expected = draw(scene, foveation::make_uniform_grid(display), pose);
  const Warped warped = warp_to(draw(scene, grid, {}), pose, display);
  EXPECT_EQ(warped.report.covered_px, 240U * 240U);
  EXPECT_GT(psnr_where_covered(warped, expected.color), 45.0);
}

TEST(Warp, AnOccludersEdgeMovesByItsOwnParallaxAndUncoversTheFartherColour) {
  // Moving 5 cm to the left (the board at x < 0 hides less)... the board at 1 m shifts by 5 cm / 1
  // m, the wall at 4 m by a quarter of that; between them the wall comes into sight.
  const auto display = square_display(300);
  const auto scene = board_before_wall(1.0, 4.0);
  const Frame frame = draw(scene, grid_with_margin(display, 60), {}, 3);
  const Pose pose{{0.05, 0.0, 0.0}, {1, 0, 0, 0}};
  const Frame expected = draw(scene, foveation::make_uniform_grid(display), pose, 3);
  const Warped warped = warp_to(frame, pose, display);
  // f = 150 / tan 30 deg = 259.8 px: 13.0 px against 3.2 px, so 9.7 px of every row open.
  EXPECT_NEAR(static_cast<double>(warped.report.filled_px) / 300.0, 9.7, 1.1);
  for (int y = 0; y < 300; ++y) {
    for (int x = 0; x < 300; ++x) {
      if (warped.coverage(x, y) != Coverage::Filled) continue;
      ASSERT_GT(warped.color(x, y).r, 250) << x << ", " << y;  // no smear of the near green
      ASSERT_LT(warped.color(x, y).g, 5);
    }
  }
  EXPECT_GT(psnr_where_covered(warped, expected.color), 30.0);
  // The edge itself stands where it should, to a pixel.
  const auto green_px = [](const image::Plane<Rgb8>& picture) {
    double sum = 0.0;
    for (const Rgb8& c : picture.pixels()) sum += c.g / 255.0;
    return sum / picture.height();
  };
  EXPECT_NEAR(green_px(warped.color), green_px(expected.color), 0.6);
}

TEST(Warp, AnUncutMeshSmearsTheOccluderAcrossTheHole) {
  // The twin that must fail the test above: with cutting off, the hole is a ramp from green to red.
  const auto display = square_display(300);
  const Frame frame = draw(board_before_wall(1.0, 4.0), grid_with_margin(display, 60), {}, 3);
  const Warped rubber = warp_to(frame, {{0.05, 0, 0}, {1, 0, 0, 0}}, display, {.cut_px = 1e6F});
  EXPECT_EQ(rubber.report.filled_px, 0U);
  int mixed = 0;
  for (const Rgb8& c : rubber.color.pixels()) mixed += c.r > 40 && c.g > 40 ? 1 : 0;
  EXPECT_GT(mixed, 300 * 5);
}

TEST(Warp, MovingTheOtherWayHidesTheWallWithoutHoles) {
  const auto display = square_display(300);
  const auto scene = board_before_wall(1.0, 4.0);
  const Frame frame = draw(scene, grid_with_margin(display, 60), {}, 3);
  const Pose pose{{-0.05, 0.0, 0.0}, {1, 0, 0, 0}};
  const Warped warped = warp_to(frame, pose, display);
  const Frame expected = draw(scene, foveation::make_uniform_grid(display), pose, 3);
  EXPECT_EQ(warped.report.filled_px, 0U);
  EXPECT_GT(psnr_where_covered(warped, expected.color), 30.0);
}

TEST(Warp, HolesStayBlackWhenAskedTo) {
  const auto display = square_display(100);
  const Frame frame = draw(board_before_wall(1.0, 4.0), grid_with_margin(display, 20), {});
  const Warped open = warp_to(frame, {{0.1, 0, 0}, {1, 0, 0, 0}}, display,
                              {.holes = WarpOptions::Holes::LeaveBlack});
  EXPECT_GT(open.report.filled_px, 100U);
  for (std::size_t i = 0; i < open.color.size(); ++i) {
    if (open.coverage.data()[i] != Coverage::Filled) continue;
    ASSERT_EQ(open.color.data()[i], Rgb8{});
  }
}

TEST(Warp, AGuardBandTurnsOutsidePixelsIntoCoveredOnes) {
  const auto display = square_display(200);
  const auto scene = textured_plane({0, 0, 1}, -2.0, 1.0);
  const Pose pose{{0, 0, 0}, turn({0, 1, 0}, Degrees{10})};
  const Warped bare =
      warp_to(draw(scene, foveation::make_uniform_grid(display), {}), pose, display);
  EXPECT_GT(bare.report.outside_px, 200U * 20U);  // 10 of 60 degrees
  const Frame wide = draw(scene, grid_with_margin(display, 60), {});
  EXPECT_EQ(warp_to(wide, pose, display).report.outside_px, 0U);
}

}  // namespace
}  // namespace macula::reprojection
