#include "server/disocclusion/hidden_layer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "server/scene/field_scene.h"
#include "server/sdf/read.h"
#include "tests/conformance/test_scenes.h"

namespace macula::disocclusion {
namespace {

using image::Plane;
using test::add_quad;
using test::add_sphere;

constexpr int kSide = 96;
constexpr double kCell_m = 0.05;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

PixelGrid grid_of(int side = kSide) {
  return foveation::make_uniform_grid(test::display(side));
}

/// A board x < 0 at 1 m before a wall at 4 m.
Plane<float> board_before_wall(const PixelGrid& grid) {
  Plane<float> depth(grid.width(), grid.height(), 4.0F);
  for (int y = 0; y < grid.height(); ++y) {
    for (int x = 0; x < grid.width(); ++x) {
      if (grid.tangent(x, y).x < 0.0F) depth(x, y) = 1.0F;
    }
  }
  return depth;
}

/// Cells of the band in the middle row: the first, and how many; all in one run.
struct Stretch {
  int first = 0, count = 0;
};
Stretch middle_run(const Band& band) {
  Stretch run;
  const auto row = band.row(band.height() / 2);
  for (int x = 0; x < band.width(); ++x) {
    if (row[x] == 0) continue;
    if (run.count++ == 0) run.first = x;
    EXPECT_EQ(x, run.first + run.count - 1) << "one run";
  }
  return run;
}

Band band_of(const Plane<float>& depth, const PixelGrid& grid, double radius_m = kCell_m,
             int threads = 2) {
  scheduling::TileScheduler scheduler(threads);
  Band band;
  find_band(depth, grid, radius_m, scheduler, band);
  return band;
}

// An eye that moves by r sees r (1/1 - 1/4) more of the tangent plane beside the board.
TEST(SilhouetteBand, IsAsWideAsWhatTheViewCellUncovers) {
  const PixelGrid grid = grid_of(384);
  const double cell = static_cast<double>(grid.footprint(0, 0).x);
  for (const double radius_m : {0.02, 0.05, 0.1}) {
    const Stretch run = middle_run(band_of(board_before_wall(grid), grid, radius_m));
    EXPECT_EQ(run.first + run.count, 192) << "it ends with the board";
    EXPECT_NEAR(run.count, 0.75 * radius_m / cell, 2.0);
  }
}

TEST(SilhouetteBand, IsEmptyWhereNothingHidesAnything) {
  const PixelGrid grid = grid_of();
  const Plane<float> sky(kSide, kSide, kInfinity);
  Plane<float> floor(kSide, kSide);  // 1.6 m below, up to a horizon at infinity
  for (int y = 0; y < kSide; ++y) {
    const float down = grid.tangent(0, y).y;
    for (int x = 0; x < kSide; ++x) floor(x, y) = down > 0.0F ? 1.6F / down : kInfinity;
  }
  for (const auto& depth : {sky, floor}) {
    const Band band = band_of(depth, grid);
    EXPECT_EQ(std::count(band.pixels().begin(), band.pixels().end(), 1), 0);
  }
}

TEST(SilhouetteBand, TakesWhatIsNoDepthForNothing) {
  const PixelGrid grid = grid_of();
  Plane<float> depth = board_before_wall(grid);
  depth(10, 10) = std::numeric_limits<float>::quiet_NaN();
  depth(11, 10) = -1.0F;
  depth(12, 10) = 0.0F;
  const Band band = band_of(depth, grid);
  for (int x = 10; x <= 12; ++x) EXPECT_EQ(band(x, 10), 0);
}

/// What is seen from the origin, and behind it.
struct Traced {
  kernels::FrameBuffers buffers;
  HiddenLayer layer;
  const Plane<float>& depth_m() const { return buffers.views[0].depth_m; }
};
Traced trace(const kernels::SceneFrame& scene, const std::string& kernel_name, int threads = 2) {
  kernels::KernelOptions options;
  options.mode = kernels::Mode::Exact;
  options.jitter = false;
  const auto kernel = kernels::make_kernel(kernel_name, options);
  EXPECT_TRUE(kernel);
  const kernels::View view = test::view_on(grid_of());
  const Vec2 cell = view.grid.footprint(0, 0);
  const FoveationMap full({{view.grid, {}, DVec2(cell)}}, {.curve = foveation::RateCurve::Uniform});
  scheduling::TileScheduler scheduler(threads);
  kernels::History history;
  Traced traced;
  (*kernel)->render({{&view, 1}, full, 0, 0}, scene, history, scheduler, traced.buffers);
  trace_hidden_layer({view, traced.depth_m(), kCell_m}, **kernel, scene, scheduler, traced.layer);
  return traced;
}

/// look(x, y) for every cell of the band; how many there were.
template <class Look>
int for_each_hidden(const HiddenLayer& layer, Look look) {
  int count = 0;
  for (int y = 0; y < layer.band.height(); ++y) {
    for (int x = 0; x < layer.band.width(); ++x) {
      if (layer.band(x, y) == 0) continue;
      look(x, y);
      ++count;
    }
  }
  return count;
}

/// A dark ball at 2 m before a wall at 4 m that shines.
scene::Scene ball_before_wall() {
  scene::Scene scene;
  scene.materials.resize(2);
  scene.materials[0].base_color = Rgb{0.1F};
  scene.materials[1].emission = {6.0F, 5.0F, 4.0F};
  add_sphere(scene, {0, 0, -2}, 0.5F, 24, 0);
  add_quad(scene, {-5, -5, -4}, {10, 0, 0}, {0, 10, 0}, 1);
  return scene;
}

TEST(HiddenLayer, HasTheWallBehindABallAndNotTheBallsBack) {
  const Traced traced = trace(*test::frame_of(ball_before_wall()), "ray");
  const int count = for_each_hidden(traced.layer, [&](int x, int y) {
    EXPECT_LT(traced.depth_m()(x, y), 2.0F) << "the ball is in front";
    EXPECT_NEAR(traced.layer.depth_m(x, y), 4.0F, 1e-5F);
    EXPECT_NEAR(traced.layer.radiance(x, y).x, 6.0F, 1e-5F);
  });
  EXPECT_GT(count, 50);
  EXPECT_EQ(static_cast<std::size_t>(count), traced.layer.cells);
}

// A whole building is one mesh often enough.
TEST(HiddenLayer, HasTheWallThoughItIsOfTheSameObject) {
  scene::Scene scene = ball_before_wall();
  scene::Mesh& ball = scene.meshes[0];
  const auto base = static_cast<scene::Index>(ball.positions.size());
  for (const Vec3& corner : scene.meshes[1].positions) ball.positions.push_back(corner);
  for (const auto& t : scene.meshes[1].triangles) {
    ball.triangles.emplace_back(base + t[0], base + t[1], base + t[2]);
  }
  scene.instances.resize(1);
  const Traced traced = trace(*test::frame_of(std::move(scene)), "ray");
  EXPECT_GT(
      for_each_hidden(traced.layer,
                      [&](int x, int y) { EXPECT_NEAR(traced.layer.depth_m(x, y), 4.0F, 1e-5F); }),
      50);
}

TEST(HiddenLayer, HasTheSkyBehindWhatStandsAlone) {
  const Traced traced = trace(*test::frame_of(test::furnace(0.5F)), "ray");
  EXPECT_GT(for_each_hidden(traced.layer,
                            [&](int x, int y) {
                              EXPECT_EQ(traced.layer.depth_m(x, y), kInfinity);
                              EXPECT_EQ(traced.layer.radiance(x, y).y, 1.0F);
                            }),
            50);
}

constexpr const char* kFieldText = R"({
  "far": 50,
  "materials": {"dark": {"color": 0.1}, "light": {"color": 0, "emission": [6, 5, 4]}},
  "scene": {"type": "union", "of": [
    {"type": "sphere", "radius": 0.5, "at": [0, 0, -2], "material": "dark"},
    {"type": "box", "half_size": [10, 10, 0.5], "at": [0, 0, -4.5], "material": "light"}]}})";

TEST(HiddenLayer, LeavesTheBallOfADistanceFieldBeforeItMeetsTheWall) {
  auto field = sdf::parse_field(kFieldText, "test");
  ASSERT_TRUE(field) << field.error().message();
  const auto scene = std::make_shared<const scene::Scene>(
      scene::scene_of(std::make_shared<const sdf::Field>(std::move(*field))));
  const Traced traced = trace(**kernels::SceneFrame::create(scene), "sphere");
  const int count = for_each_hidden(traced.layer, [&](int x, int y) {
    EXPECT_LT(traced.depth_m()(x, y), 2.0F) << "the ball is in front";
    EXPECT_NEAR(traced.layer.depth_m(x, y), 4.0F, 2e-3F);
    EXPECT_NEAR(traced.layer.radiance(x, y).x, 6.0F, 1e-4F);
  });
  EXPECT_GT(count, 50);
}

TEST(HiddenLayer, HasTheSameBitsForAnyNumberOfThreads) {
  const auto scene = test::frame_of(test::closed_room());
  const Traced one = trace(*scene, "ray", 1), three = trace(*scene, "ray", 3);
  ASSERT_GT(one.layer.cells, 20U);
  for_each_hidden(one.layer, [&](int x, int y) {
    EXPECT_EQ(three.layer.band(x, y), 1);
    EXPECT_EQ(one.layer.depth_m(x, y), three.layer.depth_m(x, y));
    EXPECT_EQ(one.layer.radiance(x, y), three.layer.radiance(x, y));
  });
  EXPECT_EQ(one.layer.cells, three.layer.cells);
}

}  // namespace
}  // namespace macula::disocclusion
