#include "shared/foveation/foveation_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace macula::foveation {
namespace {

Display display() {
  return {math::symmetric_fov(Degrees{90.0}, 1.0), 101, 101};
}

FoveationMap map_on(const PixelGrid& grid) {
  return FoveationMap({{grid, Gaze{}, display().pixel_tangent()}}, RateModel{});
}

TEST(FoveationMap, RateIsOneAtTheGazeAndFallsTowardsTheBorder) {
  const FoveationMap map = map_on(make_uniform_grid(display()));
  std::vector<float> row(101);
  map.rate_row(0, 50, row);
  EXPECT_NEAR(row[50], 1.0F, 1e-4F);
  EXPECT_TRUE(std::is_sorted(row.begin() + 50, row.end(), std::greater<>()));
  EXPECT_NEAR(row[0], row[100], 1e-6F) << "symmetric about a gaze on the axis";
}

TEST(FoveationMap, EccentricityOfTheBorderIsTheFovsHalfAngle) {
  const FoveationMap map = map_on(make_uniform_grid(display()));
  std::vector<float> row(101);
  map.eccentricity_row(0, 50, row);
  // The last cell's centre lies at tangent 100/101.
  EXPECT_NEAR(row[100], std::atan(100.0 / 101.0), 1e-6);
}

TEST(FoveationMap, SamplesWantedNeverExceedOneACellOnAFovealGrid) {
  const PixelGrid grid = make_foveal_grid(display(), Gaze{}, RateModel{});
  const FoveationMap map = map_on(grid);
  std::vector<float> row(grid.width());
  for (int y = 0; y < grid.height(); ++y) {
    map.samples_wanted_row(0, y, row);
    for (const float wanted : row) {
      EXPECT_GT(wanted, 0.0F);
      EXPECT_LE(wanted, 1.0F + 5e-4F);
    }
  }
}

}  // namespace
}  // namespace macula::foveation
