// The pure parts of kernel `culling`, each alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>

#include "server/kernels/culling/contribution.h"
#include "server/kernels/culling/importance.h"
#include "server/kernels/culling/moved_objects.h"
#include "server/kernels/culling/shading_points.h"
#include "server/kernels/culling/smoothing.h"
#include "server/kernels/culling/stochastic_culling.h"
#include "server/scene/load.h"
#include "shared/foveation/pixel_grid.h"

namespace macula::kernels::culling {
namespace {

using image::Pixel;
using lights::VirtualPointLight;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

float random(std::uint64_t i, std::uint32_t dimension) {
  return sampling::sample(1, 2, i, dimension);
}

// ---- shading points ----

Plane<float> uneven_importance() {
  Plane<float> importance(13, 7);
  for (std::size_t i = 0; i < importance.size(); ++i)
    importance.pixels()[i] = i % 5 == 0 ? 0.0F : random(i, 0);
  return importance;
}

/// Chi-square of a draw of many points, over its degrees of freedom.
double reduced_chi_square(const Plane<float>& importance, const std::vector<Pixel>& drawn) {
  std::map<std::pair<int, int>, int> counts;
  for (const Pixel& cell : drawn) ++counts[{cell.x, cell.y}];
  double all = 0.0;
  for (const float value : importance.pixels()) all += value;
  double sum = 0.0;
  int cells = 0;
  for (int y = 0; y < importance.height(); ++y) {
    for (int x = 0; x < importance.width(); ++x) {
      const double expected = importance(x, y) / all * static_cast<double>(drawn.size());
      if (!(expected > 0.0)) continue;
      const double off = counts[{x, y}] - expected;
      sum += off * off / expected, ++cells;
    }
  }
  return sum / (cells - 1);
}

TEST(ShadingPoints, FollowTheImportanceAndNeverLieWhereThereIsNone) {
  const Plane<float> importance = uneven_importance();
  std::vector<Pixel> drawn;
  for (std::uint64_t frame = 0; frame < 2000; ++frame)
    for (const Pixel& cell : draw_systematically(importance, 500, random(frame, 1)))
      drawn.push_back(cell);
  ASSERT_EQ(drawn.size(), 1'000'000U);
  for (const Pixel& cell : drawn) ASSERT_GT(importance(cell.x, cell.y), 0.0F);
  EXPECT_LT(reduced_chi_square(importance, drawn), 1.5);
}

TEST(ShadingPoints, ThePrintedChainFallsOnTheMostImportantCells) {
  const Plane<float> importance = uneven_importance();
  const auto drawn = draw_by_chains(importance, 4000, 16, {1, 2, 3});
  EXPECT_GT(reduced_chi_square(importance, drawn), 20.0);
}

TEST(ShadingPoints, AreNoneWhereNothingIsImportant) {
  EXPECT_TRUE(draw_systematically(Plane<float>(4, 4), 8, 0.5F).empty());
  EXPECT_TRUE(draw_by_chains(Plane<float>(4, 4), 8, 16, {1, 2, 3}).empty());
  EXPECT_TRUE(draw_systematically(uneven_importance(), 0, 0.5F).empty());
}

// ---- culling ----

std::vector<VirtualPointLight> some_lights(std::size_t count) {
  std::vector<VirtualPointLight> lights(count);
  for (std::size_t i = 0; i < count; ++i) {
    lights[i].position = DVec3(static_cast<double>(i), 0.0, 0.0);
    lights[i].flux = Rgb{0.1F + random(i, 0)};
  }
  return lights;
}
std::vector<float> some_contributions(std::size_t count) {
  std::vector<float> contributions(count);
  for (std::size_t i = 0; i < count; ++i)
    contributions[i] = i % 3 == 0 ? 0.0F : std::pow(random(i, 1), 4.0F);
  return contributions;
}

/// Flux of what is kept over all flux, mean of many frames and its standard error.
struct Kept {
  double mean = 0.0, error = 0.0;
};
Kept kept_share(const Config& config) {
  const auto lights = some_lights(600);
  const auto contributions = some_contributions(600);
  double all = 0.0, sum = 0.0, square = 0.0;
  for (const auto& light : lights) all += light.flux.x;
  constexpr int kFrames = 1000;
  for (int frame = 0; frame < kFrames; ++frame) {
    double flux = 0.0;
    for (const auto& light : cull(lights, contributions, config, random(frame, 2)))
      flux += light.flux.x;
    sum += flux / all, square += flux / all * flux / all;
  }
  const double mean = sum / kFrames;
  return {mean, std::sqrt((square / kFrames - mean * mean) / kFrames)};
}

TEST(StochasticCulling, KeepsAllLightOnAverageAndUnweightedLosesIt) {
  Config config;
  config.kept = 64;
  const Kept weighted = kept_share(config);
  EXPECT_LT(std::abs(weighted.mean - 1.0), 4.0 * weighted.error + 1e-6);
  EXPECT_LT(weighted.error, 0.02);
  config.weights = CullWeights::None;
  const Kept unweighted = kept_share(config);
  EXPECT_GT(std::abs(unweighted.mean - 1.0), 4.0 * unweighted.error + 0.1);
}

/// What `lights` bring to the points, nothing hidden, luminance in W/m^2.
std::vector<double> irradiances(std::span<const VirtualPointLight> lights,
                                std::span<const ShadingPoint> points) {
  std::vector<double> sums(points.size(), 0.0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (const VirtualPointLight& light : lights) {
      const auto arrival = lights::arriving(light, DVec3(points[i].position), 0.02);
      if (!arrival) continue;
      const float cosine = std::max(glm::dot(points[i].normal, arrival->to_light), 0.0F);
      sums[i] += static_cast<double>(cosine * image::luminance(arrival->irradiance));
    }
  }
  return sums;
}

/// Points at which the mean over culled sets is more than four standard errors off every light's.
int points_off(std::span<const VirtualPointLight> lights, std::span<const float> contribution,
               std::span<const ShadingPoint> points, const Config& config) {
  constexpr int kSets = 400;
  const std::vector<double> all = irradiances(lights, points);
  std::vector<double> sum(points.size(), 0.0), square(points.size(), 0.0);
  for (std::uint64_t set = 0; set < kSets; ++set) {
    const auto now = irradiances(cull(lights, contribution, config, random(set, 3)), points);
    for (std::size_t i = 0; i < now.size(); ++i) sum[i] += now[i], square[i] += now[i] * now[i];
  }
  int off = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double mean = sum[i] / kSets;
    const double error = std::sqrt(std::max(square[i] / kSets - mean * mean, 0.0) / kSets);
    off += std::abs(mean - all[i]) > 4.0 * error + 1e-5 * all[i] ? 1 : 0;
  }
  return off;
}

// 64 points on a floor under a lit wall, a few of which told the contributions: the others were
// never asked, and still have all the light on average.
TEST(StochasticCulling, IrradianceUnderCulledSetsIsEveryLightsOnAverageAndUnweightedItIsNot) {
  std::vector<VirtualPointLight> lights(512);
  for (std::size_t i = 0; i < lights.size(); ++i) {
    lights[i].position = DVec3{4.0 * random(i, 0), 3.0 * random(i, 1), 0.0};
    lights[i].normal = Vec3{0, 0, 1};
    lights[i].footprint_m = 0.05F;
    lights[i].flux = Rgb{0.2F + random(i, 2)};
  }
  std::vector<ShadingPoint> points;
  for (std::uint64_t i = 0; i < 64; ++i) {
    const Vec3 place{4.0F * random(i, 4), 0.0F, 0.2F + 3.0F * random(i, 5)};
    points.push_back({place, Vec3{0, 1, 0}, 1.0F, 0.5F});
  }
  const auto loaded = scene::load_scene("cornell");
  ASSERT_TRUE(loaded);
  const auto frame = SceneFrame::create(*loaded);
  ASSERT_TRUE(frame);
  Config config;
  config.kept = 64, config.visibility_rays = 0;
  scheduling::TileScheduler scheduler(1);
  const auto told =
      contributions(**frame, lights, std::span(points).first(4), config, 0.02, 0, scheduler);
  EXPECT_LE(points_off(lights, told.unhidden, points, config), 1);
  config.weights = CullWeights::None;
  EXPECT_GT(points_off(lights, told.unhidden, points, config), 48);
}

TEST(StochasticCulling, KeepsNoMoreThanItMayAndAllWhereItMay) {
  Config config;
  config.kept = 64;
  const auto lights = some_lights(600);
  const auto kept = cull(lights, some_contributions(600), config, 0.3F);
  EXPECT_LE(kept.size(), 64U);
  EXPECT_GT(kept.size(), 30U);
  config.kept = 600;
  const auto all = cull(lights, some_contributions(600), config, 0.3F);
  ASSERT_EQ(all.size(), 600U);
  for (std::size_t i = 0; i < 600; ++i) EXPECT_EQ(all[i].flux, lights[i].flux);
}

TEST(StochasticCulling, GoesByFluxWhereNothingContributes) {
  Config config;
  config.kept = 50;
  const std::vector<float> nothing(600, 0.0F);
  const auto kept = cull(some_lights(600), nothing, config, 0.3F);
  EXPECT_EQ(kept.size(), 50U);
  EXPECT_TRUE(cull({}, {}, config, 0.3F).empty());
}

// ---- contribution ----

// Light that falls on one of many points matters more than as much that falls on all of them; the
// printed mean does not tell them apart.
TEST(Contribution, IsTheRootMeanSquareOfWhatPointsReceive) {
  const auto loaded = scene::load_scene("cornell");
  ASSERT_TRUE(loaded);
  const auto frame = SceneFrame::create(*loaded);
  ASSERT_TRUE(frame);
  const std::vector<VirtualPointLight> lights{
      {DVec3{0.0, 0.5, 0.0}, Vec3{0, -1, 0}, 0.01F, Rgb{1.0F}}};
  std::vector<ShadingPoint> points;
  for (int i = 0; i < 8; ++i)
    points.push_back({Vec3{0.1F * static_cast<float>(i), 0.0F, 0.0F}, Vec3{0, 1, 0}, 1.0F, 0.5F});
  double mean = 0.0, square = 0.0;
  for (const ShadingPoint& point : points) {
    const auto arrival = lights::arriving(lights[0], DVec3(point.position));
    ASSERT_TRUE(arrival);
    const double brings =
        0.5 * static_cast<double>(arrival->to_light.y) * static_cast<double>(arrival->irradiance.x);
    mean += brings / 8.0, square += brings * brings / 8.0;
  }
  Config config;
  config.visibility_rays = 0;
  scheduling::TileScheduler scheduler(1);
  const auto told = [&](PointMean of) {
    config.mean = of;
    return static_cast<double>(
        contributions(**frame, lights, points, config, 0.0, 0, scheduler).unhidden[0]);
  };
  EXPECT_NEAR(told(PointMean::OfSquares), square, 1e-4 * square);
  EXPECT_NEAR(told(PointMean::Plain), mean, 1e-4 * mean);
  EXPECT_GT(square, 1.1 * mean * mean) << "they differ here";
}

// ---- importance ----

/// A wall at a slant, a step in its middle column, and nothing in the last row.
struct Scene {
  Plane<float> acuity{16, 12, 0.3F}, depth{16, 12}, brightness;
  Plane<Vec3> normal{16, 12, Vec3{0, 0, 1}};
  Plane<Rgb> albedo{16, 12, Rgb{0.5F}};
  Scene() {
    for (int y = 0; y < 12; ++y)
      for (int x = 0; x < 16; ++x)
        depth(x, y) = y == 11 ? kInfinity : 1.0F / (0.4F + 0.01F * static_cast<float>(x));
  }
  Plane<float> importance() const {
    return make_importance({acuity, depth, normal, albedo, brightness}, {});
  }
};

TEST(Importance, HasNoEdgesOnASlantedPlaneAndSomeAtSilhouettes) {
  Scene scene;
  Plane<float> importance = scene.importance();
  EXPECT_FLOAT_EQ(importance(5, 5), 0.3F);
  EXPECT_FLOAT_EQ(importance(5, 10), 0.6F) << "beside nothing";
  EXPECT_FLOAT_EQ(importance(5, 11), 0.0F) << "nothing there";
  scene.albedo(8, 5) = Rgb{0.9F, 0.1F, 0.1F};
  scene.normal(3, 3) = Vec3{1, 0, 0};
  scene.depth(12, 8) = 1.0F;
  importance = scene.importance();
  for (const Pixel& edge : {Pixel{8, 5}, Pixel{7, 5}, Pixel{3, 3}, Pixel{3, 4}, Pixel{12, 8}})
    EXPECT_FLOAT_EQ(importance(edge.x, edge.y), 0.6F) << edge.x << ' ' << edge.y;
  EXPECT_FLOAT_EQ(importance(5, 7), 0.3F);
}

TEST(Importance, NeverFallsToNothingInTheDark) {
  Scene scene;
  scene.brightness = Plane<float>(16, 12, 0.0F);
  EXPECT_FLOAT_EQ(scene.importance()(5, 5), 0.3F * 0.05F);
  scene.brightness(5, 5) = kInfinity;
  EXPECT_FLOAT_EQ(scene.importance()(5, 5), 0.3F) << "not known";
}

TEST(Importance, BringsTheFoveaItsShareAndLeavesWhatHasMore) {
  Plane<float> acuity(4, 1, 0.2F), weights(4, 1, 1.0F);
  acuity(2, 0) = 1.0F, weights(2, 0) = 0.5F;
  Plane<float> focused = weights;
  focus(acuity, 0.5F, focused);
  EXPECT_FLOAT_EQ(focused(2, 0), 3.0F) << "as much as the three others";
  EXPECT_FLOAT_EQ(focused(0, 0), 1.0F);
  focus(acuity, 0.25F, focused);
  EXPECT_FLOAT_EQ(focused(2, 0), 3.0F) << "never less";
  weights(2, 0) = 0.0F;
  focus(acuity, 0.5F, weights);
  EXPECT_FLOAT_EQ(weights(2, 0), 0.0F) << "nothing is there";
}

TEST(Importance, ColorsDifferAsTheEyeSeesThem) {
  EXPECT_EQ(color_distance(Rgb{0.5F}, Rgb{0.5F}), 0.0F);
  EXPECT_NEAR(color_distance(Rgb{0.0F}, Rgb{1.0F}), 255.0F * 3.0F, 1e-2F);
  EXPECT_GT(color_distance(Rgb{0.0F}, Rgb{0, 1, 0}), color_distance(Rgb{0.0F}, Rgb{0, 0, 1}));
}

// ---- smoothing ----

struct Picture {
  View view;
  ViewBuffers buffers;
  Picture() {
    view.grid = foveation::make_uniform_grid({math::symmetric_fov(Degrees{60.0}, 1.0), 24, 24});
    buffers.depth_m.resize(24, 24, 2.0F);
    buffers.normal.resize(24, 24, Vec3{0, 0, 1});
    buffers.light.resize(24, 24);
    // Classes of 4 x 4 cells that hold a sixteenth of the light each, as many times too bright.
    for (int y = 0; y < 24; ++y)
      for (int x = 0; x < 24; ++x)
        buffers.light(x, y) = Rgb{static_cast<float>(x % 4 + 4 * (y % 4))};
  }
};

TEST(Smoothing, CountsEveryClassOnce) {
  const Picture picture;
  TileScheduler scheduler(1);
  const Plane<Rgb> light = shared_light(picture.view, picture.buffers, 2, scheduler);
  for (int y = 2; y < 22; ++y)
    for (int x = 2; x < 22; ++x) EXPECT_NEAR(light(x, y).x, 7.5F, 1e-4F) << x << ' ' << y;
}

TEST(Smoothing, StopsAtEdges) {
  Picture picture;
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 24; ++x) {
      picture.buffers.light(x, y) = Rgb{x < 12 ? 1.0F : 5.0F};
      if (x >= 12) picture.buffers.depth_m(x, y) = 3.0F;
    }
  }
  TileScheduler scheduler(1);
  const Plane<Rgb> light = shared_light(picture.view, picture.buffers, 2, scheduler);
  EXPECT_FLOAT_EQ(light(11, 12).x, 1.0F);
  EXPECT_FLOAT_EQ(light(12, 12).x, 5.0F);
}

/// So many that a new one counts for no more than it must.
Plane<float> many_frames() {
  return Plane<float>(24, 24, 100.0F);
}

TEST(Smoothing, RemembersWhatStaysAndForgetsWhatIsOutOfRange) {
  Picture picture;
  std::ranges::fill(picture.buffers.light.pixels(), Rgb{1.0F});
  ViewMemory then{picture.view.world_from_view,  picture.view.grid,
                  picture.buffers.depth_m,       picture.buffers.normal,
                  Plane<Rgb>(24, 24, Rgb{9.0F}), many_frames()};
  TileScheduler scheduler(1);
  const auto at_middle = [&](float newest) {
    const auto mean = remembered(picture.view, picture.buffers, then, {}, newest, scheduler,
                                 picture.buffers.light);
    return mean.light(12, 12).x;
  };
  EXPECT_FLOAT_EQ(at_middle(0.25F), 1.0F) << "nine is not in the range of what is seen";
  picture.buffers.light(13, 12) = Rgb{2.0F};
  then.light = Plane<Rgb>(24, 24, Rgb{1.5F});
  EXPECT_FLOAT_EQ(at_middle(0.25F), 0.75F * 1.5F + 0.25F * 1.0F);
}

// A quarter for the newest from the second frame on would leave the first, the noisiest, with more
// than all others together for a while.
TEST(Smoothing, AveragesTheFirstFramesAlike) {
  Picture picture;
  std::ranges::fill(picture.buffers.light.pixels(), Rgb{0.0F});
  picture.buffers.light(13, 12) = Rgb{10.0F};  // no bounds
  ViewMemory memory{picture.view.world_from_view, picture.view.grid,
                    picture.buffers.depth_m,      picture.buffers.normal,
                    picture.buffers.light,        Plane<float>(24, 24, 1.0F)};
  TileScheduler scheduler(1);
  float sum = 0.0F;
  for (int frame = 2; frame <= 6; ++frame) {
    const float now = 0.5F * static_cast<float>(frame);
    picture.buffers.light(12, 12) = Rgb{now};
    auto mean = remembered(picture.view, picture.buffers, memory, {}, 0.25F, scheduler,
                           picture.buffers.light);
    const float expected = frame <= 4 ? (sum + now) / static_cast<float>(frame)
                                      : 0.75F * memory.light(12, 12).x + 0.25F * now;
    EXPECT_FLOAT_EQ(mean.light(12, 12).x, expected) << frame;
    EXPECT_FLOAT_EQ(mean.frames(12, 12), std::min(static_cast<float>(frame), 4.0F));
    memory.light = std::move(mean.light), memory.frames = std::move(mean.frames);
    sum += now;
  }
}

TEST(Smoothing, RemembersWhatMovedWhereItWas) {
  Picture picture;
  ViewMemory then{picture.view.world_from_view, picture.view.grid,  picture.buffers.depth_m,
                  picture.buffers.normal,       Plane<Rgb>(24, 24), many_frames()};
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 24; ++x) {
      picture.buffers.light(x, y) = Rgb{x % 2 == 0 ? 0.0F : 100.0F};  // no bounds
      then.light(x, y) = Rgb{static_cast<float>(x)};
    }
  }
  constexpr int kCells = 3;
  const double cell_m = 2.0 * (picture.view.grid.x_edges[1] - picture.view.grid.x_edges[0]);
  reconstruction::Movers movers;
  movers.of.resize(24, 24, 0U);
  for (int y = 0; y < 24; ++y) movers.of(12, y) = 1;
  movers.then_from_now.resize(1);
  movers.then_from_now.front().position = {-kCells * cell_m, 0.0, 0.0};
  TileScheduler scheduler(1);
  const Plane<Rgb> light = remembered(picture.view, picture.buffers, then, movers, 0.5F, scheduler,
                                      picture.buffers.light)
                               .light;
  EXPECT_NEAR(light(12, 12).x, 0.5F * (12 - kCells), 1e-3F) << "three cells to the left then";
  EXPECT_NEAR(light(14, 12).x, 0.5F * 14, 1e-3F) << "beside it nothing moved";
}

TEST(MovedObjects, AreFoundInCellsAndLedBackToWhereTheyWere) {
  const auto scene = *scene::load_scene("moving");
  const auto before = *SceneFrame::create(scene, {units::from_s(0.2)});
  const auto now = *SceneFrame::create(scene, {units::from_s(0.3)});
  const auto count = static_cast<int>(scene->instances.size());
  ViewBuffers buffers;
  buffers.surface_id.resize(count + 1, 1);  // nothing, then every instance
  for (int x = 0; x <= count; ++x) buffers.surface_id(x, 0) = static_cast<std::uint32_t>(x);
  ASSERT_TRUE(has_moving_objects(*now));
  const auto movers = movers_in(buffers, places_of_objects(*before), *now);
  EXPECT_GT(movers.then_from_now.size(), 3U);
  EXPECT_EQ(movers.of(0, 0), 0U);
  for (int x = 1; x <= count; ++x) {
    const DMat4& to = now->pose().world_from_object[x - 1];
    const DMat4& from = before->pose().world_from_object[x - 1];
    const DVec3 place(to * DVec4(0.1, 0.2, 0.3, 1.0)), was(from * DVec4(0.1, 0.2, 0.3, 1.0));
    if (movers.of(x, 0) == 0) continue;
    const Pose& then_from_now = movers.then_from_now[movers.of(x, 0) - 1];
    EXPECT_LT(glm::distance(then_from_now.rotation * place + then_from_now.position, was), 1e-5);
  }
  EXPECT_TRUE(movers_in(buffers, places_of_objects(*now), *now).then_from_now.empty());
  EXPECT_TRUE(movers_in(buffers, {}, *now).then_from_now.empty()) << "a first frame";
}

TEST(Smoothing, ClampsInOddWindowsThatGrowOutwards) {
  int last = 3;
  for (float q = 0.0F; q <= 1.0F; q += 0.01F) {
    const int window = clamp_window(q);
    EXPECT_EQ(window % 2, 1);
    EXPECT_GE(window, last);
    last = window;
  }
  EXPECT_EQ(clamp_window(0.0F), 3);
  EXPECT_EQ(last, 9);
}

}  // namespace
}  // namespace macula::kernels::culling
