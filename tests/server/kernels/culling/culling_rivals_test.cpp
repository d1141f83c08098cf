// Other ways to the light that kernel `culling` finds: cuts of a tree, lights from the camera,
// fewer rays, fewer texels, a guess in the place of visibility rays.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "server/kernels/culling/culling_kernel.h"
#include "server/kernels/culling/light_cuts.h"
#include "server/kernels/culling/local_openness.h"
#include "server/kernels/culling/texel_map.h"
#include "shared/foveation/eccentricity.h"
#include "tests/conformance/test_scenes.h"

namespace macula::kernels::culling {
namespace {

std::shared_ptr<const SceneFrame> lambert_room() {
  scene::Scene scene = test::closed_room();
  scene.settings.ambient = Rgb{0.0F};
  scene.materials[2].emission = Rgb{0.0F};
  return test::frame_of(std::move(scene));
}

View view_of(int side) {
  return test::view_on(foveation::make_uniform_grid(test::display(side, 70.0)));
}

Config config_of(Mode mode) {
  KernelOptions options;
  options.mode = mode;
  options.jitter = false;
  options.ambient_samples = 0;
  options.lambert_only = true;
  Config config = make_config(options);
  config.kept = 256;
  config.classes = 16, config.asked = 0, config.space = Space::Cells;
  return config;
}

struct Mean {
  double value = 0.0, error = 0.0;
};
Mean mean_luminance(const Config& config, const SceneFrame& scene, const View& view, int frames) {
  const CullingKernel kernel(config);
  const FoveationMap map({{view.grid, view.gaze, DVec2{1e-3}}}, foveation::RateModel{});
  TileScheduler scheduler(2);
  History history;
  FrameBuffers out;
  double sum = 0.0, square = 0.0;
  for (int i = 0; i < frames; ++i) {
    kernel.render({{&view, 1}, map, static_cast<std::uint64_t>(i), 1}, scene, history, scheduler,
                  out);
    const double mean = image::luminance(Rgb(test::mean(out.views.front().radiance)));
    sum += mean, square += mean * mean;
  }
  const double mean = sum / frames;
  return {mean, std::sqrt(std::max(square / frames - mean * mean, 0.0) / (frames - 1))};
}

/// Mode Exact with everything kept by classes, which other tests hold to paths.
Mean wanted(const SceneFrame& scene, const View& view) {
  return mean_luminance(config_of(Mode::Exact), scene, view, 60);
}

void expect_alike(const Mean& a, const Mean& b) {
  EXPECT_LT(std::abs(a.value - b.value), 4.0 * std::hypot(a.error, b.error));
}

TEST(CullingRivals, CutsAndFewRaysHaveTheSameMeanAndLightThatNothingHidesHasMore) {
  const auto scene = lambert_room();
  const View view = view_of(12);
  const Mean all = wanted(*scene, view);
  Config some = config_of(Mode::Exact);
  some.asked = 4;
  expect_alike(mean_luminance(some, *scene, view, 60), all);
  Config cuts = config_of(Mode::Exact);
  cuts.route = Route::Cuts;
  expect_alike(mean_luminance(cuts, *scene, view, 60), all);
  Config unhidden = config_of(Mode::Exact);
  unhidden.shadows = ray::VirtualShadows::None;
  const Mean more = mean_luminance(unhidden, *scene, view, 60);
  EXPECT_GT(more.value, all.value + 4.0 * std::hypot(more.error, all.error));
}

// A third of half the room counts as near: what that takes is much.
TEST(CullingRivals, ShortRaysBringBackWhatCappingTakesFromCorners) {
  const auto scene = lambert_room();
  const View view = view_of(12);
  Config far = config_of(Mode::Exact);
  far.nearest = 0.0F;
  const Mean all = mean_luminance(far, *scene, view, 100);
  Config near = config_of(Mode::Exact);
  near.nearest = 0.4F;
  const Mean back = mean_luminance(near, *scene, view, 60);
  expect_alike(back, all);
  EXPECT_LT(back.error, all.error) << "the reason for capping";
  near.near_light = ray::NearLight::Lost;
  const Mean lost = mean_luminance(near, *scene, view, 60);
  EXPECT_LT(lost.value, back.value - 4.0 * std::hypot(lost.error, back.error));
}

TEST(CullingRivals, LightsFromTheCameraAndTexelsLoseLittleOfTheLight) {
  const auto scene = lambert_room();
  const View view = view_of(48);
  Config config = config_of(Mode::Fast);
  const double cells = mean_luminance(config, *scene, view, 8).value;
  for (const Space space : {Space::Thinned, Space::LogPolar}) {
    config.space = space;
    EXPECT_NEAR(mean_luminance(config, *scene, view, 8).value, cells, 0.03 * cells);
  }
  config.space = Space::Cells;
  config.source = LightSource::Camera;
  EXPECT_NEAR(mean_luminance(config, *scene, view, 8).value, cells, 0.08 * cells);
}

// ---- texels ----

foveation::Display display() {
  return test::display(256, 90.0);
}

/// A smooth picture taken at the texels and brought back, in dB within 10 degrees of the gaze.
double round_trip_db(const TexelMap& map, const PixelGrid& grid, const Gaze& gaze) {
  const auto smooth = [](double x, double y) {
    return 0.5 + 0.25 * std::sin(0.1 * x) * std::cos(0.08 * y);
  };
  double square = 0.0;
  int count = 0;
  for (int y = 0; y < grid.height(); ++y) {
    for (int x = 0; x < grid.width(); ++x) {
      if (foveation::eccentricity(gaze.direction, grid.ray(x, y)) > Radians{Degrees{10.0}})
        continue;
      const Vec2 place = map.place(x, y) - 0.5F, corner = glm::floor(place), t = place - corner;
      double value = 0.0;
      for (int k = 0; k < 4; ++k) {
        const int u = std::clamp(static_cast<int>(corner.x) + k % 2, 0, map.width() - 1);
        int v = static_cast<int>(corner.y) + k / 2;
        v = map.wraps() ? (v + map.height()) % map.height() : std::clamp(v, 0, map.height() - 1);
        const Pixel cell = map.cell(u, v);
        const float weight = (k % 2 == 0 ? 1.0F - t.x : t.x) * (k / 2 == 0 ? 1.0F - t.y : t.y);
        value += static_cast<double>(weight) * smooth(cell.x, cell.y);
      }
      const double off = value - smooth(x, y);
      square += off * off, ++count;
    }
  }
  return -10.0 * std::log10(square / count);
}

TEST(TexelMap, BringsASmoothPictureBackWhereTheEyeLooks) {
  const PixelGrid grid = foveation::make_uniform_grid(display());
  for (const Vec3& direction : {Vec3{0, 0, -1}, glm::normalize(Vec3{0.5F, -0.3F, -1.0F})}) {
    Gaze gaze;
    gaze.direction = direction;
    for (const double rings : {1.0, 4.0})
      EXPECT_GT(round_trip_db(TexelMap::log_polar(grid, gaze, 1.8, rings), grid, gaze), 40.0);
    EXPECT_GT(round_trip_db(TexelMap::thinned(grid, 2), grid, gaze), 40.0);
    EXPECT_LT(round_trip_db(TexelMap::thinned(grid, 16), grid, gaze), 30.0) << "coarser ones lose";
  }
}

TEST(TexelMap, IsDefinedForAnyGazeAndSize) {
  Gaze behind;
  behind.direction = {0.0F, 0.6F, 0.8F};
  for (const int side : {1, 2, 7}) {
    const PixelGrid grid = foveation::make_uniform_grid(test::display(side, 90.0));
    for (const TexelMap& map :
         {TexelMap::log_polar(grid, behind, 1.8, 1.0), TexelMap::thinned(grid, 2)}) {
      for (int v = 0; v < map.height(); ++v) {
        for (int u = 0; u < map.width(); ++u) {
          EXPECT_LT(map.cell(u, v).x, side);
          EXPECT_LT(map.cell(u, v).y, side);
        }
      }
      const Vec2 place = map.place(side - 1, 0);
      EXPECT_TRUE(std::isfinite(place.x) && std::isfinite(place.y));
    }
  }
}

// ---- cuts and guesses ----

TEST(LightCuts, AreAsLargeOnAverageAsAskedAndLargerWhereItMatters) {
  const PixelGrid grid = foveation::make_uniform_grid(test::display(16, 90.0));
  image::Plane<float> importance(4, 4, 0.2F);
  importance(1, 2) = 1.0F;
  const auto sizes = cut_sizes(grid, importance, 4, 10.0, 100);
  double sum = 0.0;
  for (const std::uint16_t size : sizes.pixels()) sum += size;
  EXPECT_NEAR(sum / 256.0, 10.0, 0.5);
  EXPECT_EQ(sizes(5, 9), 5 * sizes(0, 0));
  EXPECT_EQ(cut_sizes(grid, image::Plane<float>(4, 4), 4, 10.0, 100)(3, 3), 1) << "never none";
}

TEST(LampMaps, TellWhatLampsSeeAndCallEverythingOpenWithoutLamps) {
  const auto scene = lambert_room();
  TileScheduler scheduler(1);
  const LampMaps maps(*scene, 4.0F, scheduler);
  const Vec3 lamp(scene->lights().punctual().front().position);
  const Openness near_lamp = maps.around(lamp - Vec3{0.0F, 0.3F, 0.0F}, Vec3{0, 1, 0});
  EXPECT_EQ(near_lamp.towards(Vec3{0, 1, 0}), 1.0F) << "the lamp sees all of it";
  scene::Scene dark = test::closed_room();
  dark.lights.clear();
  const LampMaps none(*test::frame_of(std::move(dark)), 4.0F, scheduler);
  EXPECT_EQ(none.around(Vec3{0.0F}, Vec3{0, 1, 0}).towards(Vec3{1, 0, 0}), 1.0F);
  // Right at a surface that the lamp sees, positions lie within its threshold or behind it.
  const auto floor = scene->intersect(visibility::Ray{lamp, Vec3{0.05F, -1.0F, 0.02F}});
  ASSERT_TRUE(floor);
  const Vec3 place = lamp + floor->t * Vec3{0.05F, -1.0F, 0.02F};
  EXPECT_LT(maps.around(place, Vec3{0, 1, 0}).towards(Vec3{1, 0, 0}), 1.0F);
}

}  // namespace
}  // namespace macula::kernels::culling
