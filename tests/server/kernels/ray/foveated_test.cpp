// The foveated method as a whole, on scenes of a few surfaces.
#include "server/kernels/ray/foveated.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "server/kernels/ray/cache.h"
#include "server/kernels/ray/ray_kernel.h"
#include "shared/foveation/eccentricity.h"
#include "shared/metrics/error.h"
#include "tests/conformance/test_scenes.h"

namespace macula::kernels::ray {
namespace {

const foveation::RateModel kMedium{foveation::RateCurve::Ray, Degrees{10.0}, Degrees{20.0}, 0.05};
const foveation::RateModel kFull{foveation::RateCurve::Uniform, Degrees{0.0}, Degrees{0.0}, 1.0};

Config foveated_config() {
  Config config;
  config.area_light_samples = 2;
  config.ambient_samples = 2;
  config.foveated.method = Method::Foveated;
  return config;
}

/// A kernel, what it remembers, and what it last made.
struct Viewer {
  explicit Viewer(std::shared_ptr<const SceneFrame> shown, const Config& config = foveated_config(),
                  foveation::RateModel model = kMedium, int threads = 2)
      : scene(std::move(shown)), kernel(config), rate(model), scheduler(threads) {}

  const ViewBuffers& render(const View& view, std::uint64_t frame) {
    const foveation::Display screen = test::display(view.grid.width(), 90.0);
    const FoveationMap map({{view.grid, view.gaze, screen.pixel_tangent()}}, rate);
    report = kernel.render({{&view, 1}, map, frame, 1}, *scene, history, scheduler, buffers);
    return buffers.views.front();
  }

  std::shared_ptr<const SceneFrame> scene;
  RayKernel kernel;
  foveation::RateModel rate;
  TileScheduler scheduler;
  History history;
  FrameBuffers buffers;
  FrameReport report;
};

View view_of(int side) {
  return test::view_on(foveation::make_uniform_grid(test::display(side, 90.0)));
}
/// One lamp, nothing left to chance but the place of samples in their cells.
scene::Scene lamp_room() {
  scene::Scene scene = test::closed_room();
  scene.settings.ambient = Rgb{0.0F};
  for (scene::Material& material : scene.materials) material.emission = Rgb{0.0F};
  return scene;
}

bool same_bits(const Plane<Rgb>& a, const Plane<Rgb>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Rgb)) == 0;
}
bool all_finite(const Plane<Rgb>& plane) {
  for (const Rgb& value : plane.pixels()) {
    if (!math::is_finite(value)) return false;
  }
  return true;
}
/// Within 10 degrees of the view axis.
double fovea_rmse(const Plane<Rgb>& a, const Plane<Rgb>& b, const PixelGrid& grid) {
  double sum = 0.0;
  int count = 0;
  for (int y = 0; y < grid.height(); ++y) {
    for (int x = 0; x < grid.width(); ++x) {
      const Radians e = foveation::eccentricity(Vec3{0, 0, -1}, grid.ray(x, y));
      if (Degrees{e}.value() > 10.0) continue;
      const Rgb d = a(x, y) - b(x, y);
      sum += glm::dot(d, d), ++count;
    }
  }
  return std::sqrt(sum / (3.0 * count));
}

TEST(Foveated, AtRateOneItsFirstFrameIsTheFullRenderersBitForBit) {
  const auto scene = test::frame_of(test::closed_room());
  const View view = view_of(60);
  Config full = foveated_config();
  full.foveated.method = Method::Full;
  Viewer foveated(scene, foveated_config(), kFull), reference(scene, full, kFull);
  EXPECT_TRUE(same_bits(foveated.render(view, 3).radiance, reference.render(view, 3).radiance));
  EXPECT_EQ(foveated.report.primary_rays, reference.report.primary_rays);
}

TEST(Foveated, InModeExactNothingIsRememberedAndEveryCellIsTraced) {
  const auto scene = test::frame_of(test::closed_room());
  const View view = view_of(40);
  Config exact = foveated_config();
  exact.mode = Mode::Exact;
  Viewer foveated(scene, exact);
  exact.foveated.method = Method::Full;
  Viewer full(scene, exact);
  for (std::uint64_t frame = 0; frame < 3; ++frame) {
    EXPECT_TRUE(
        same_bits(foveated.render(view, frame).radiance, full.render(view, frame).radiance));
  }
  EXPECT_EQ(foveated.history.record, nullptr);
  EXPECT_TRUE(foveated.report.biased_shortcuts.empty());
}

TEST(Foveated, TheFirstFrameHasNoBlackCellsAndFewerRays) {
  const auto scene = test::frame_of(test::closed_room());
  Viewer run(scene);
  const auto black_cells = [](const ViewBuffers& out) {
    int black = 0;
    for (const Rgb& value : out.radiance.pixels()) black += image::luminance(value) <= 0.0F;
    return black;
  };
  const int black = black_cells(run.render(view_of(160), 0));
  Config full = foveated_config();
  full.foveated.method = Method::Full;
  Viewer reference(scene, full);
  // Corners that no light sample reached.
  EXPECT_LE(black, black_cells(reference.render(view_of(160), 0)));
  EXPECT_LT(run.report.primary_rays, 160U * 160U / 3U);
  EXPECT_GT(run.report.filled_cells, 0U);
  EXPECT_FALSE(run.report.biased_shortcuts.empty());
}

TEST(Foveated, AViewAtRestConvergesToTheAntiAliasedPicture) {
  const auto scene = test::frame_of(lamp_room());
  const View view = view_of(120);
  Config many = foveated_config();
  many.samples_per_cell = 256;
  many.foveated.method = Method::Full;
  Viewer reference(scene, many);
  const Plane<Rgb> truth = reference.render(view, 1000).radiance;
  Viewer run(scene);
  std::vector<double> errors;
  for (std::uint64_t frame = 0; frame < 48; ++frame) {
    errors.push_back(fovea_rmse(run.render(view, frame).radiance, truth, view.grid));
  }
  // n samples are worth 1 / sqrt(n) of one, until the least weight of 0.1 makes 19 of them.
  EXPECT_NEAR(errors[3] / errors[0], 0.5, 0.12);
  EXPECT_NEAR(errors[47] / errors[0], 1.0 / std::sqrt(19.0), 0.1);
  // The periphery gets there by the mask alone.
  EXPECT_LT(metrics::rmse(truth, run.buffers.views.front().radiance), errors[0]);
}

TEST(Foveated, AViewThatDoesNotMoveReprojectsToTheSameBits) {
  const auto scene = test::frame_of(lamp_room());
  const View view = view_of(80);
  Viewer run(scene);
  run.render(view, 0);
  const auto* record = dynamic_cast<RayRecord*>(run.history.record.get());
  ASSERT_NE(record, nullptr);
  const Cache& cache = record->views.front().now;
  const Plane<Texel> before = cache.color;
  const Plane<CacheInfo> info = cache.info;
  run.render(view, 1);
  // Cells nobody traced in the second frame are worth what they were.
  int kept = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (cache.info.pixels()[i].samples != info.pixels()[i].samples) continue;
    if (info.pixels()[i].samples == 0.0F) continue;  // filled anew from the support
    ++kept;
    ASSERT_EQ(0, std::memcmp(&before.pixels()[i], &cache.color.pixels()[i], sizeof(Texel))) << i;
  }
  EXPECT_GT(kept, 100);
}

Pose yawed(double degrees) {
  return {DVec3{0.0}, glm::angleAxis(Radians{Degrees{degrees}}.value(), DVec3{0, 1, 0})};
}

// A turn moves a checker exactly; what is off by half a cell shows the neighbouring square.
TEST(Foveated, AfterAPureTurnEdgesLieWithinHalfACell) {
  scene::Scene room = lamp_room();
  room.materials[0].pattern = scene::Pattern{scene::PatternKind::Checker, Rgb{0.02F}, 0.5F};
  const auto scene = test::frame_of(std::move(room));
  Config config = foveated_config();
  config.foveated.filter = HistoryFilter::Bilinear;
  Viewer run(scene, config);
  View view = view_of(160);
  for (std::uint64_t frame = 0; frame < 60; ++frame) run.render(view, frame);
  view.world_from_view = yawed(1.7);
  const Plane<Rgb> seen = run.render(view, 60).radiance;
  Config full = config;
  full.foveated.method = Method::Full;
  full.samples_per_cell = 64;
  Viewer reference(scene, full);
  const auto error_of_turn = [&](double degrees) {
    View turned = view;
    turned.world_from_view = yawed(degrees);
    return metrics::rmse(reference.render(turned, 9).radiance, seen);
  };
  // Half a cell is 0.18 degrees in the middle of 90 degrees over 160 cells.
  const double right = error_of_turn(1.7);
  EXPECT_LT(right, 0.75 * error_of_turn(1.7 + 0.36));
  EXPECT_LT(right, 0.75 * error_of_turn(1.7 - 0.36));
}

/// Mean of what displays show beyond 15 degrees from the axis, [0, 1].
double shown_outside(const Plane<Rgb>& radiance, const View& view) {
  double sum = 0.0;
  int count = 0;
  for (int y = 0; y < radiance.height(); ++y) {
    for (int x = 0; x < radiance.width(); ++x) {
      const Radians e = foveation::eccentricity(Vec3{0, 0, -1}, view.grid.ray(x, y));
      if (Degrees{e}.value() < 15.0) continue;
      sum += std::sqrt(std::max(image::luminance(radiance(x, y)), 0.0F)), ++count;
    }
  }
  return sum / count;
}
/// Means of 3 x 3 cells.
Plane<Rgb> blurred(const Plane<Rgb>& sharp) {
  Plane<Rgb> soft = sharp;
  for (int y = 1; y + 1 < sharp.height(); ++y) {
    for (int x = 1; x + 1 < sharp.width(); ++x) {
      Rgb sum{0.0F};
      for (int k = 0; k < 9; ++k) sum += sharp(x + k % 3 - 1, y + k / 3 - 1);
      soft(x, y) = sum / 9.0F;
    }
  }
  return soft;
}

// A memory of radiance, moved every frame, showed plants and carpets too bright: the mean of a
// bright and a dark cell is shown nearly as bright as the bright one.
TEST(Foveated, WhatIsCarriedThroughATurnIsShownAsBrightAsItIs) {
  scene::Scene room = lamp_room();
  room.materials[0].pattern = scene::Pattern{scene::PatternKind::Checker, Rgb{0.02F}, 0.1F};
  const auto scene = test::frame_of(std::move(room));
  Viewer run(scene);
  View view = view_of(160);
  for (int frame = 0; frame < 32; ++frame) {
    view.world_from_view = yawed(0.13 * frame);
    run.render(view, static_cast<std::uint64_t>(frame));
  }
  Config many = foveated_config();
  many.samples_per_cell = 64;
  many.foveated.method = Method::Full;
  Viewer reference(scene, many);
  const Plane<Rgb> truth = reference.render(view, 99).radiance;
  const double right = shown_outside(truth, view);
  const double excess = shown_outside(run.buffers.views.front().radiance, view) - right;
  // The twin: a blur of radiance over three cells.
  EXPECT_LT(std::abs(excess), 0.5 * (shown_outside(blurred(truth), view) - right));
}

/// A wall that gleams, or does not, along a sideways walk of 1.2 cm a frame.
struct Walk {
  std::shared_ptr<const SceneFrame> scene;
  View view = view_of(160);

  explicit Walk(float roughness) {
    scene::Scene wall;
    wall.materials.resize(1);
    wall.materials[0].metallic = 0.7F, wall.materials[0].roughness = roughness;
    test::add_quad(wall, {-6, -4, -3}, {12, 0, 0}, {0, 8, 0}, 0);
    scene::Light lamp;
    lamp.intensity = Rgb{4.0F}, lamp.position = {-1.5, 0.5, -1.0};
    wall.lights = {lamp};
    scene = test::frame_of(std::move(wall));
  }
  void to(int frame) { view.world_from_view.position = {0.012 * frame - 0.2, 0.1, 0.0}; }
  /// Of the picture after the walk, outside the fovea, display-linear; and what was resampled.
  struct End {
    double rmse = 0.0, resampled = 0.0;
  };
  End end(const FoveatedConfig& foveated) {
    Config config = foveated_config();
    config.foveated = foveated, config.foveated.method = Method::Foveated;
    Viewer run(scene, config);
    End found;
    constexpr int kFrames = 32;
    for (int frame = 0; frame < kFrames; ++frame) {
      to(frame);
      run.render(view, static_cast<std::uint64_t>(frame));
      if (frame > 8) found.resampled += static_cast<double>(run.report.resampled_cells);
    }
    Config many = foveated_config();
    many.samples_per_cell = 64, many.foveated.method = Method::Full;
    Viewer reference(scene, many);
    const Plane<Rgb> truth = reference.render(view, 99).radiance;
    double sum = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const Rgb d = glm::min(truth.pixels()[i], Rgb{1.0F}) -
                    glm::min(run.buffers.views.front().radiance.pixels()[i], Rgb{1.0F});
      sum += glm::dot(d, d);
    }
    found.rmse = std::sqrt(sum / (3.0 * static_cast<double>(truth.size())));
    return found;
  }
};

// What lies still is remembered right, but a highlight slides over it as the eye walks.
TEST(Foveated, GlossyPointsAreTracedAnewWhereTheEyeHasGoneAroundThem) {
  FoveatedConfig blind;
  blind.turn_threshold = std::numeric_limits<float>::infinity();
  Walk gleaming(0.3F), dull(1.0F);
  const Walk::End seen = gleaming.end({}), unseen = gleaming.end(blind);
  EXPECT_LT(seen.rmse, 0.8 * unseen.rmse);
  EXPECT_GT(seen.resampled, unseen.resampled);
  // The twin: nothing that is broad calls for more.
  EXPECT_EQ(dull.end({}).resampled, dull.end(blind).resampled);
}

TEST(Foveated, OneThreadAndManyGiveTheSameBitsAlongAPath) {
  const auto scene = test::frame_of(test::closed_room());
  Viewer one(scene, foveated_config(), kMedium, 1), many(scene, foveated_config(), kMedium, 4);
  for (int frame = 0; frame < 6; ++frame) {
    View view = view_of(96);
    view.world_from_view = yawed(0.8 * frame);
    view.world_from_view.position = {0.02 * frame, 0.01 * frame, -0.03 * frame};
    const auto number = static_cast<std::uint64_t>(frame);
    const ViewBuffers& a = one.render(view, number);
    const ViewBuffers& b = many.render(view, number);
    EXPECT_TRUE(same_bits(a.radiance, b.radiance)) << frame;
    EXPECT_EQ(0, std::memcmp(a.depth_m.data(), b.depth_m.data(), a.depth_m.size() * sizeof(float)));
  }
  EXPECT_EQ(one.report.primary_rays, many.report.primary_rays);
}

TEST(Foveated, AfterACutTheFoveaHasNoGhostWithinTwoFrames) {
  const auto scene = test::frame_of(lamp_room());
  View view = view_of(120);
  Viewer travelled(scene), fresh(scene);
  for (std::uint64_t frame = 0; frame < 10; ++frame) travelled.render(view, frame);
  view.world_from_view = {DVec3{0.8, 0.3, -0.5}, yawed(60.0).rotation};
  for (std::uint64_t frame = 10; frame < 12; ++frame) {
    travelled.render(view, frame);
    fresh.render(view, frame);
  }
  Config many = foveated_config();
  many.samples_per_cell = 64;
  many.foveated.method = Method::Full;
  Viewer reference(scene, many);
  const Plane<Rgb> truth = reference.render(view, 99).radiance;
  const auto error = [&](const Viewer& run) {
    return fovea_rmse(run.buffers.views.front().radiance, truth, view.grid);
  };
  EXPECT_LE(error(travelled), 1.2 * error(fresh));
}

TEST(Foveated, ABudgetOfRaysIsMetWithinAFewFramesAndTheFoveaStaysWhole) {
  const auto scene = test::frame_of(lamp_room());
  const auto share_along_a_path = [&](float budget) {
    Config config = foveated_config();
    config.foveated.ray_budget = budget;
    Viewer run(scene, config);
    double traced = 0.0;
    for (int frame = 0; frame < 24; ++frame) {
      View view = view_of(128);
      view.world_from_view = yawed(0.3 * frame);
      run.render(view, static_cast<std::uint64_t>(frame));
      if (frame >= 16) traced += static_cast<double>(run.report.primary_rays);
    }
    return traced / (8.0 * 128.0 * 128.0);
  };
  const double free = share_along_a_path(1.0F);
  const double budget = 0.85 * free;
  EXPECT_NEAR(share_along_a_path(static_cast<float>(budget)), budget, 0.03 * budget);
  // A hopeless budget leaves the support and the fovea.
  EXPECT_GT(share_along_a_path(1e-3F), 0.4 * free);
}

TEST(Foveated, EveryFormAsPrintedGivesFinitePicturesToo) {
  const auto scene = test::frame_of(test::closed_room());
  Config config = foveated_config();
  config.foveated = paper_literal();
  config.foveated.post_filter = PostFilter::On;
  Viewer run(scene, config);
  for (int frame = 0; frame < 4; ++frame) {
    View view = view_of(64);
    view.world_from_view = yawed(frame);
    EXPECT_TRUE(all_finite(run.render(view, static_cast<std::uint64_t>(frame)).radiance));
  }
}

TEST(Foveated, FrameNumbersMayWrapTheClockOfTheCache) {
  const auto scene = test::frame_of(lamp_room());
  Viewer run(scene);
  run.render(view_of(32), ~std::uint64_t{0} - 1);
  dynamic_cast<RayRecord*>(run.history.record.get())->clock = ~std::uint32_t{0} - 1;
  for (int frame = 0; frame < 4; ++frame) {
    View view = view_of(32);
    view.world_from_view = yawed(frame);
    EXPECT_TRUE(all_finite(run.render(view, ~std::uint64_t{0} + frame).radiance));
  }
}

TEST(Foveated, GridsOfOneCellAndFovealOnesNeedNothingSpecial) {
  const auto scene = test::frame_of(test::closed_room());
  const auto screen = test::display(200, 90.0);
  const PixelGrid foveal = foveation::make_foveal_grid(screen, Gaze{}, kMedium);
  for (const PixelGrid& grid : {foveation::make_uniform_grid(test::display(1, 90.0)), foveal}) {
    Viewer run(scene);
    View view = test::view_on(grid);
    const FoveationMap map({{grid, view.gaze, screen.pixel_tangent()}}, kMedium);
    for (std::uint64_t frame = 0; frame < 3; ++frame) {
      view.world_from_view = yawed(0.5 * static_cast<double>(frame));
      run.report = run.kernel.render({{&view, 1}, map, frame, 1}, *scene, run.history,
                                     run.scheduler, run.buffers);
      EXPECT_TRUE(all_finite(run.buffers.views.front().radiance));
      EXPECT_LE(run.report.primary_rays, grid.x_edges.size() * grid.y_edges.size());
    }
  }
}

TEST(Foveated, AStopRequestForgetsTheHalfMadeFrame) {
  Viewer run(test::frame_of(lamp_room()));
  run.render(view_of(48), 0);
  std::stop_source source;
  source.request_stop();
  run.scheduler.set_stop_token(source.get_token());
  run.render(view_of(48), 1);
  EXPECT_TRUE(run.report.stopped);
  run.scheduler.set_stop_token({});
  const ViewBuffers& out = run.render(view_of(48), 2);
  EXPECT_FALSE(run.report.stopped);
  EXPECT_TRUE(all_finite(out.radiance));
}

}  // namespace
}  // namespace macula::kernels::ray
