#include "shared/foveation/pixel_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "shared/foveation/eccentricity.h"

namespace macula::foveation {
namespace {

Display headset() {
  return {Fov{Degrees{-50.0}, Degrees{45.0}, Degrees{48.0}, Degrees{-52.0}}, 720, 800};
}

Gaze gaze_deg(double yaw_deg, double pitch_deg) {
  const double yaw = Radians{Degrees{yaw_deg}}.value(), pitch = Radians{Degrees{pitch_deg}}.value();
  return {.direction = {static_cast<float>(std::sin(yaw) * std::cos(pitch)),
                        static_cast<float>(std::sin(pitch)),
                        static_cast<float>(-std::cos(yaw) * std::cos(pitch))}};
}

/// On the axis, off it, in a corner, at the border, off-screen to each side and behind the head.
std::vector<Gaze> gazes() {
  return {gaze_deg(0, 0),    gaze_deg(13, -7), gaze_deg(-44, 42),
          gaze_deg(45, 0),   gaze_deg(70, 10), gaze_deg(-80, -60),
          gaze_deg(0, 89.9), gaze_deg(120, 0), gaze_deg(180, 0)};
}

double share_of_cells(const PixelGrid& grid, const Display& display) {
  return static_cast<double>(grid.width()) * grid.height() / display.width_px / display.height_px;
}

/// Largest rate wanted at the corners and centre of a cell.
double rate_wanted(const PixelGrid& grid, int x, int y, const Gaze& gaze, const RateModel& model) {
  double wanted = 0.0;
  for (const auto& [fx, fy] :
       {std::pair{0.5F, 0.5F}, {0.F, 0.F}, {1.F, 0.F}, {0.F, 1.F}, {1.F, 1.F}}) {
    wanted = std::max(wanted, model.rate(eccentricity(gaze.direction, grid.ray(x, y, fx, fy))));
  }
  return wanted;
}

/// Cells (sampled every third) whose density is below the rate wanted inside them.
int cells_too_coarse(const PixelGrid& grid, const Display& display, const Gaze& gaze,
                     const RateModel& model) {
  const DVec2 pixel = display.pixel_tangent();
  int too_coarse = 0;
  for (int y = 0; y < grid.height(); y += 3) {
    for (int x = 0; x < grid.width(); x += 3) {
      const Vec2 cell = grid.footprint(x, y);
      const double density = pixel.x * pixel.y / (static_cast<double>(cell.x) * cell.y);
      // Edges are floats: a cell of 1e-3 around tangent 1 is off by 6e-5 of its size on each side.
      if (density < rate_wanted(grid, x, y, gaze, model) * (1.0 - 5e-4)) ++too_coarse;
    }
  }
  return too_coarse;
}

TEST(PixelGrid, UniformGridHasOneCellAPixelAndSpansTheFov) {
  const Display display = headset();
  const PixelGrid grid = make_uniform_grid(display);
  EXPECT_EQ(grid.width(), 720);
  EXPECT_EQ(grid.height(), 800);
  EXPECT_FLOAT_EQ(grid.x_edges.front(), static_cast<float>(display.fov.tangent_min().x));
  EXPECT_FLOAT_EQ(grid.y_edges.back(), static_cast<float>(display.fov.tangent_max().y));
  EXPECT_TRUE(is_valid(grid));
}

TEST(FovealGrid, DensityNeverFallsBelowTheRateForAnyGazeAndModel) {
  const Display display = headset();
  for (const RatePreset& preset : rate_presets()) {
    for (const Gaze& gaze : gazes()) {
      const PixelGrid grid = make_foveal_grid(display, gaze, preset.model);
      ASSERT_TRUE(is_valid(grid)) << preset.name;
      EXPECT_EQ(cells_too_coarse(grid, display, gaze, preset.model), 0)
          << preset.name << " gaze " << gaze.direction.x << ' ' << gaze.direction.y;
    }
  }
}

TEST(FovealGrid, TheDensityTestRejectsAGridMadeForAnotherGaze) {
  const Display display = headset();
  const RateModel model;
  const PixelGrid elsewhere = make_foveal_grid(display, gaze_deg(-30, 20), model);
  EXPECT_GT(cells_too_coarse(elsewhere, display, gaze_deg(20, -20), model), 100);
}

TEST(FovealGrid, CoversTheWholeViewWithoutSlivers) {
  const Display display = headset();
  for (const Gaze& gaze : gazes()) {
    const PixelGrid grid = make_foveal_grid(display, gaze, RateModel{});
    EXPECT_NEAR(grid.x_edges.front(), display.fov.tangent_min().x, 1e-6);
    EXPECT_NEAR(grid.x_edges.back(), display.fov.tangent_max().x, 1e-6);
    EXPECT_NEAR(grid.y_edges.front(), display.fov.tangent_min().y, 1e-6);
    EXPECT_NEAR(grid.y_edges.back(), display.fov.tangent_max().y, 1e-6);
    for (int x = 0; x < grid.width(); ++x) {
      EXPECT_GT(grid.footprint(x, 0).x, 0.4 * display.pixel_tangent().x);
    }
  }
}

TEST(FovealGrid, FovealCellsAreBitEqualToTheDisplaysOwnPixels) {
  const Display display = headset();
  const PixelGrid uniform = make_uniform_grid(display);
  const std::set<float> raster_x(uniform.x_edges.begin(), uniform.x_edges.end());
  const std::set<float> raster_y(uniform.y_edges.begin(), uniform.y_edges.end());
  const Gaze gaze = gaze_deg(13, -7);
  const PixelGrid grid = make_foveal_grid(display, gaze, RateModel{});
  int foveal = 0;
  for (int y = 0; y < grid.height(); ++y) {
    for (int x = 0; x < grid.width(); ++x) {
      if (Degrees{eccentricity(gaze.direction, grid.ray(x, y))} > Degrees{5.0}) continue;
      ++foveal;
      ASSERT_TRUE(raster_x.contains(grid.x_edges[x]) && raster_x.contains(grid.x_edges[x + 1]));
      ASSERT_TRUE(raster_y.contains(grid.y_edges[y]) && raster_y.contains(grid.y_edges[y + 1]));
    }
  }
  // 5.7 pixels a degree on the axis: a disc of 5 degrees there holds pi 28.6^2 = 2570 of them, and
  // slightly more off it, where a tangent pixel subtends less.
  EXPECT_GT(foveal, 2570);
}

TEST(FovealGrid, EqualRectanglesHaveEqualKeysAndOthersDiffer) {
  const Display display = headset();
  const PixelGrid uniform = make_uniform_grid(display);
  const PixelGrid foveal = make_foveal_grid(display, gaze_deg(0, 0), RateModel{});
  const auto at = foveal.locate({0.0F, 0.0F}).value();
  const auto same = uniform.locate({0.0F, 0.0F}).value();
  EXPECT_EQ(foveal.cell_key(static_cast<int>(at.x), static_cast<int>(at.y)),
            uniform.cell_key(static_cast<int>(same.x), static_cast<int>(same.y)));
  std::set<std::uint64_t> keys;
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 100; ++x) keys.insert(uniform.cell_key(x, y));
  }
  EXPECT_EQ(keys.size(), 10000U);
}

TEST(FovealGrid, UniformRateReproducesTheUniformGrid) {
  const Display display = headset();
  EXPECT_EQ(make_foveal_grid(display, gaze_deg(5, 5), find_rate_model("uniform").value()),
            make_uniform_grid(display));
}

TEST(FovealGrid, SavesMostCellsOfAHeadsetView) {
  const Display display = headset();
  const double share =
      share_of_cells(make_foveal_grid(display, gaze_deg(0, 0), RateModel{}), display);
  EXPECT_LT(share, 0.35);
  EXPECT_GT(share, 0.05);
}

TEST(FovealGrid, OversamplingPutsThatManyCellsOnAPixelAtTheGaze) {
  const Display display = headset();
  for (const double oversampling : {1.0, 1.5, 2.0, 3.0}) {
    const PixelGrid grid = make_foveal_grid(display, gaze_deg(10, 10), RateModel{},
                                            {.fovea_oversampling = oversampling});
    const Vec2 at = grid.project(gaze_deg(10, 10).direction).value();
    const Vec2 cell = grid.footprint(static_cast<int>(at.x), static_cast<int>(at.y));
    EXPECT_NEAR(display.pixel_tangent().x / cell.x, oversampling, 1e-3);
    EXPECT_NEAR(display.pixel_tangent().y / cell.y, oversampling, 1e-3);
  }
}

TEST(FovealGrid, AGuardBandWidensTheViewByItsAngle) {
  const Display display = headset();
  const PixelGrid grid =
      make_foveal_grid(display, gaze_deg(0, 0), RateModel{}, {.guard_band = Degrees{10.0}});
  EXPECT_NEAR(std::atan(grid.x_edges.front()), Radians{Degrees{-60.0}}.value(), 1e-5);
  EXPECT_NEAR(std::atan(grid.y_edges.back()), Radians{Degrees{62.0}}.value(), 1e-5);
  EXPECT_EQ(cells_too_coarse(grid, display, gaze_deg(0, 0), RateModel{}), 0);
}

TEST(PixelGrid, LocateInvertsTangentEverywhereAndRefusesTheOutside) {
  const PixelGrid grid = make_foveal_grid(headset(), gaze_deg(13, -7), RateModel{});
  for (int y = 0; y < grid.height(); y += 7) {
    for (int x = 0; x < grid.width(); x += 5) {
      const Vec2 found = grid.locate(grid.tangent(x, y, 0.25F, 0.75F)).value();
      ASSERT_NEAR(found.x, static_cast<float>(x) + 0.25F, 1e-3F);
      ASSERT_NEAR(found.y, static_cast<float>(y) + 0.75F, 1e-3F);
    }
  }
  EXPECT_FALSE(grid.locate({10.0F, 0.0F}));
  EXPECT_FALSE(grid.locate({std::nanf(""), 0.0F}));
  EXPECT_FALSE(grid.project({0.0F, 0.0F, 1.0F})) << "behind the eye";
}

TEST(PixelGrid, ValidityRefusesTablesThatDoNotIncrease) {
  PixelGrid grid{{0.0F, 0.1F, 0.2F}, {0.0F, 0.1F}};
  EXPECT_TRUE(is_valid(grid));
  grid.x_edges[2] = 0.1F;
  EXPECT_FALSE(is_valid(grid));
  EXPECT_FALSE(is_valid(PixelGrid{{0.0F}, {0.0F, 1.0F}}));
  EXPECT_FALSE(is_valid(PixelGrid{{0.0F, std::nanf("")}, {0.0F, 1.0F}}));
}

}  // namespace
}  // namespace macula::foveation
