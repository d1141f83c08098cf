#include "client/display/headless/rate_map.h"

#include <gtest/gtest.h>

#include "shared/image/draw.h"

namespace macula::display {
namespace {

foveation::Display square_display() {
  return {math::symmetric_fov(Degrees{90.0}, 1.0), 64, 64};
}

TEST(RateMap, IsOneEverywhereOnTheDisplaysOwnGrid) {
  const auto grid = foveation::make_uniform_grid(square_display());
  for (const float x : {-0.99F, -0.3F, 0.0F, 0.7F}) {
    EXPECT_NEAR(cell_density(grid, square_display(), {x, 0.5F * x}), 1.0F, 1e-4F);
  }
  EXPECT_EQ(cell_density(grid, square_display(), {1.5F, 0.0F}), 0.0F);
}

// A cell of two by four nominal pixels: an eighth of a cell per pixel.
TEST(RateMap, IsTheInverseOfTheCellAreaInNominalPixels) {
  const auto display = square_display();
  const auto pixel = Vec2(display.pixel_tangent());
  const PixelGrid grid{{0.0F, 2.0F * pixel.x, 3.0F * pixel.x}, {0.0F, 4.0F * pixel.y}};
  EXPECT_NEAR(cell_density(grid, display, {pixel.x, pixel.y}), 0.125F, 1e-5F);
  EXPECT_NEAR(cell_density(grid, display, {2.5F * pixel.x, pixel.y}), 0.25F, 1e-5F);
}

TEST(RateMap, DrawsTheGazeWhereTheGridIsDensest) {
  const auto display = square_display();
  Gaze gaze;
  gaze.direction = glm::normalize(Vec3{0.5F, 0.25F, -1.0F});  // right of and above the middle
  foveation::FovealGridOptions options;
  options.full_rate_radius = Degrees{4.0};
  const auto grid = make_foveal_grid(display, gaze, {}, options);
  const auto map = draw_rate_map(grid, display, gaze);
  // Tangents run from -1 to 1 over 64 pixels, y down: the gaze is at (48, 24).
  const Rgb8 cross = map(48, 24);
  EXPECT_GT(cross.r, 200);
  EXPECT_LT(cross.g, 100);
  EXPECT_EQ(map(50, 26), image::false_color(1.0F)) << "full rate beside the cross";
  EXPECT_GT(cell_density(grid, display, {0.5F, -0.25F}),
            2.0F * cell_density(grid, display, {-0.9F, 0.9F}));
}

}  // namespace
}  // namespace macula::display
