#include "server/kernels/sphere/sphere_kernel.h"

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <memory>

#include "server/scene/field_scene.h"
#include "server/scene/load.h"
#include "server/sdf/read.h"
#include "shared/foveation/eccentricity.h"

namespace macula::kernels::sphere {
namespace {

using image::Plane;

constexpr int kSide = 160;

std::shared_ptr<const SceneFrame> frame_of(const std::string& name, double time_s = 0.0) {
  const auto loaded = scene::load_scene(name);
  EXPECT_TRUE(loaded) << (loaded ? "" : loaded.error().message());
  const auto frame = SceneFrame::create(*loaded, SceneTime{units::from_s(time_s)});
  EXPECT_TRUE(frame);
  return *frame;
}

std::shared_ptr<const SceneFrame> frame_of_text(const char* text) {
  auto field = sdf::parse_field(text, "test");
  EXPECT_TRUE(field) << (field ? "" : field.error().message());
  const auto scene = std::make_shared<const scene::Scene>(
      scene::scene_of(std::make_shared<const sdf::Field>(std::move(*field))));
  return *SceneFrame::create(scene);
}

View view_of(const SceneFrame& scene, int side = kSide, double fov_deg = 90.0) {
  View view;
  view.grid =
      foveation::make_uniform_grid({math::symmetric_fov(Degrees{fov_deg}, 1.0), side, side});
  if (!scene.pose().world_from_view.empty())
    view.world_from_view = scene.pose().world_from_view.front();
  return view;
}

constexpr float kNoDetail = std::numeric_limits<float>::infinity();
constexpr unsigned kPlanes = kSurfaceId | kNormal | kAlbedo | kSamples | kSteps | kVariance;

/// Frames of one session.
class Session {
 public:
  explicit Session(const Config& config, int threads = 2) : kernel_(config), scheduler_(threads) {
    buffers_.wanted = kPlanes;
  }
  const ViewBuffers& next(const SceneFrame& scene, const View& view) {
    const FoveationMap map({{view.grid, view.gaze, DVec2{1e-3}}}, foveation::RateModel{});
    report_ = kernel_.render({{&view, 1}, map, frame_++, 1}, scene, history_, scheduler_, buffers_);
    return buffers_.views.front();
  }
  const FrameReport& report() const { return report_; }

 private:
  SphereKernel kernel_;
  TileScheduler scheduler_;
  History history_;
  FrameBuffers buffers_;
  FrameReport report_;
  std::uint64_t frame_ = 0;
};

Config unfoveated(Tracing tracing, int samples = 1) {
  Config config;
  config.tracing = tracing;
  config.foveation = Foveation::Off;
  config.samples_per_cell = samples;
  return config;
}

bool same_bits(const Plane<Rgb>& a, const Plane<Rgb>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Rgb)) == 0;
}

double mean_difference(const Plane<Rgb>& a, const Plane<Rgb>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
    sum += std::abs(image::luminance(a.pixels()[i]) - image::luminance(b.pixels()[i]));
  return sum / static_cast<double>(a.size());
}

constexpr const char* kBall = R"({
  "sky": 0.25, "far": 50,
  "materials": {"white": {"color": 0.5}},
  "suns": [{"direction": [0, 0, -1], "irradiance": 3}],
  "scene": {"type": "sphere", "radius": 1, "at": [0, 0, -4], "material": "white"}
})";

TEST(SphereKernel, ABallLiesWhereItIsAndReflectsWhatItMust) {
  const auto scene = frame_of_text(kBall);
  const View view = view_of(*scene, 101);
  Session session(unfoveated(Tracing::Pyramid));
  const ViewBuffers& planes = session.next(*scene, view);
  // The middle: 3 m away, facing the sun: (3 / pi + 0.25) * 0.5.
  EXPECT_NEAR(planes.depth_m(50, 50), 3.0F, 1e-2F);
  EXPECT_NEAR(planes.radiance(50, 50).x, (3.0 / 3.14159265 + 0.25) * 0.5, 1e-3);
  EXPECT_NEAR(planes.normal(50, 50).z, 1.0F, 1e-3F);
  EXPECT_EQ(planes.surface_id(50, 50), 1U + 0U);
  EXPECT_TRUE(std::isinf(planes.depth_m(0, 0)));
  EXPECT_EQ(planes.radiance(0, 0), Rgb{0.25F});
  EXPECT_EQ(planes.surface_id(0, 0), 0U);
}

TEST(SphereKernel, ThePyramidShowsThePictureOfPlainTracing) {
  for (const char* name : {"primitives", "columns"}) {
    const auto scene = frame_of(name);
    const View view = view_of(*scene);
    Session plain(unfoveated(Tracing::Full)), pyramid(unfoveated(Tracing::Pyramid));
    const ViewBuffers& expected = plain.next(*scene, view);
    const ViewBuffers& own = pyramid.next(*scene, view);
    int wrong = 0;
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        const float a = expected.depth_m(x, y), b = own.depth_m(x, y);
        // Apart across the surface: a grazing ray may end anywhere within the hit distance of it.
        const DVec3 ray = glm::normalize(DVec3(view.grid.ray(x, y)));
        const auto slope = static_cast<float>(std::abs(
            glm::dot(view.world_from_view.transform_direction(ray), DVec3(expected.normal(x, y)))));
        wrong += std::isinf(a) || std::isinf(b) ? std::isinf(a) != std::isinf(b)
                                                : std::abs(a - b) * slope > 0.004F * a;
      }
    }
    // Rays that graze a silhouette within the hit distance, and those that plain tracing gave up.
    const auto unfinished = static_cast<int>(plain.report().unfinished_rays);
    EXPECT_LE(wrong, kSide * kSide / 2500 + unfinished) << name;
    EXPECT_LT(unfinished, kSide * kSide / 50) << name;
    EXPECT_LT(mean_difference(expected.radiance, own.radiance),
              1e-3 + static_cast<double>(unfinished) / (kSide * kSide))
        << name;
    EXPECT_LT(pyramid.report().field_evaluations, plain.report().field_evaluations) << name;
  }
}

TEST(SphereKernel, SameBitsForAnyNumberOfThreads) {
  Config config;
  config.refresh = Refresh::EveryFourth;
  Session one(config, 1), three(config, 3);
  for (int i = 0; i < 3; ++i) {
    const auto scene = frame_of("primitives", 0.02 * i);
    const View view = view_of(*scene);
    EXPECT_TRUE(same_bits(one.next(*scene, view).radiance, three.next(*scene, view).radiance)) << i;
  }
}

/// Mean square of differences relative to the luminance of `a`, at least 0.01.
double relative_square(const Plane<Rgb>& a, const Plane<Rgb>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double wanted = image::luminance(a.pixels()[i]), got = image::luminance(b.pixels()[i]);
    sum += std::pow((got - wanted) / std::max(wanted, 0.01), 2.0);
  }
  return sum / static_cast<double>(a.size());
}

/// Lighting and patterns have vectors of their own.
TEST(SphereKernel, EveryInstructionSetShowsTheSamePicture) {
  const auto scene = frame_of("columns", 1.0);
  const View view = view_of(*scene, 96);
  const Config config = unfoveated(Tracing::Pyramid);
  const Plane<Rgb> best = Session(config).next(*scene, view).radiance;
  int sets = 0;
  for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1, ++sets) {
    hwy::SetSupportedTargetsForTest(rest & -rest);
    const Plane<Rgb> shown = Session(config).next(*scene, view).radiance;
    hwy::SetSupportedTargetsForTest(0);
    EXPECT_LE(relative_square(best, shown), 1e-4) << hwy::TargetName(rest & -rest);
  }
  EXPECT_GE(sets, 2);
  // 2 % too bright must be seen.
  Plane<Rgb> bright = best;
  for (Rgb& color : bright.pixels()) color *= 1.02F;
  EXPECT_GT(relative_square(best, bright), 1e-4);
}

TEST(SphereKernel, TheFoveaIsThatOfTheUnfoveatedPicture) {
  const auto scene = frame_of("temple");
  View view = view_of(*scene);
  view.gaze.direction = glm::normalize(Vec3{0.1F, -0.05F, -1.0F});
  Config config = unfoveated(Tracing::Pyramid, 4);
  Session whole(config);
  config.foveation = Foveation::On;
  Session foveated(config);
  const ViewBuffers& expected = whole.next(*scene, view);
  const ViewBuffers& own = foveated.next(*scene, view);
  int inside = 0;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const Degrees e{foveation::eccentricity(view.gaze.direction, view.grid.ray(x, y))};
      if (e.value() > config.mask.fovea.value()) continue;
      ++inside;
      EXPECT_EQ(own.radiance(x, y), expected.radiance(x, y)) << x << ", " << y;
      EXPECT_EQ(own.samples(x, y), 4.0F);
    }
  }
  EXPECT_GT(inside, 300);
  EXPECT_LT(foveated.report().field_evaluations, whole.report().field_evaluations / 3);
}

/// Cells of the fovea with other bits than the plain picture's, a share.
double unequal_in_fovea(const ViewBuffers& plain, const ViewBuffers& own, const View& view,
                        double fovea_deg) {
  int inside = 0, unequal = 0;
  for (int y = 0; y < plain.radiance.height(); ++y) {
    for (int x = 0; x < plain.radiance.width(); ++x) {
      const Degrees e{foveation::eccentricity(view.gaze.direction, view.grid.ray(x, y))};
      if (e.value() > fovea_deg) continue;
      ++inside;
      unequal += own.radiance(x, y) != plain.radiance(x, y);
    }
  }
  EXPECT_GT(inside, 5000);
  return static_cast<double>(unequal) / inside;
}

/// It was FLIP .0014 off, then .0001: rays of foveated pictures stopped elsewhere within the hit
/// distance.
TEST(SphereKernel, TheFoveaHasTheBitsOfPlainTracing) {
  for (const char* name : {"primitives", "columns", "temple"}) {
    const auto scene = frame_of(name);
    const View view = view_of(*scene, kSide, 12.0);  // a headset's pixels
    Config config;
    config.mask.fovea = Degrees{4.0};
    config.mask.outer = Degrees{8.0};
    Session plain(unfoveated(Tracing::Full)), foveated(config), thinner([&] {
      Config other = config;
      other.mask.fovea = Degrees{1.0};
      return other;
    }());
    const ViewBuffers& expected = plain.next(*scene, view);
    EXPECT_EQ(unequal_in_fovea(expected, foveated.next(*scene, view), view, 4.0), 0.0) << name;
    EXPECT_GT(unequal_in_fovea(expected, thinner.next(*scene, view), view, 4.0), 0.2) << name;
  }
}

TEST(SphereKernel, WhatIsKeptOfAStillSceneIsWhatWouldBeTraced) {
  const auto scene = frame_of("primitives");
  const View view = view_of(*scene);
  Config config;
  config.detail = kNoDetail;
  config.mask.rule = MaskRule::Literal;  // its random mask aside, the same frame again and again
  config.mask.fovea = Degrees{0.5};
  config.mask.outer = Degrees{1.0};
  Session fresh(config);
  config.refresh = Refresh::EveryFourth;
  config.kept = Kept::InPlace;
  Session kept(config);
  const Plane<Rgb> expected = fresh.next(*scene, view).radiance;
  kept.next(*scene, view);
  const std::uint64_t first = kept.report().primary_rays;
  for (int i = 1; i < 6; ++i) {
    EXPECT_LT(mean_difference(kept.next(*scene, view).radiance, expected), 2e-3) << "frame " << i;
    EXPECT_LT(kept.report().primary_rays, 3 * first / 4) << "frame " << i;
  }
}

TEST(SphereKernel, WhatIsKeptFollowsAMovingHeadBetterThanInPlace) {
  const auto scene = frame_of("primitives");
  Config config;
  config.detail = kNoDetail;
  config.mask.fovea = Degrees{0.5};
  config.mask.outer = Degrees{1.0};
  Session fresh(config);
  config.refresh = Refresh::EveryFourth;
  Session reprojected(config);
  config.kept = Kept::InPlace;
  Session in_place(config);
  double error_reprojected = 0.0, error_in_place = 0.0;
  View view = view_of(*scene);
  for (int i = 0; i < 5; ++i) {
    view.world_from_view.rotation =
        view.world_from_view.rotation * glm::angleAxis(0.02, DVec3{0.0, 1.0, 0.0});
    const Plane<Rgb> expected = fresh.next(*scene, view).radiance;
    error_reprojected += mean_difference(reprojected.next(*scene, view).radiance, expected);
    error_in_place += mean_difference(in_place.next(*scene, view).radiance, expected);
  }
  EXPECT_LT(error_reprojected, 0.3 * error_in_place);
}

TEST(SphereKernel, EdgesOfPatternsAreTracedFarFromTheGaze) {
  const auto scene = frame_of("primitives");
  const View view = view_of(*scene);
  for (const int samples : {1, 16}) {
    Session whole(unfoveated(Tracing::Pyramid, samples));
    const Plane<Rgb> expected = whole.next(*scene, view).radiance;
    Config config;
    config.samples_per_cell = samples;
    config.block_samples = block_samples_for(samples);
    config.refresh = Refresh::EveryFourth;
    Session detailed(config);
    config.detail = kNoDetail;
    Session drawn(config);
    for (int i = 0; i < 3; ++i) {
      const double error = mean_difference(detailed.next(*scene, view).radiance, expected);
      const double without = mean_difference(drawn.next(*scene, view).radiance, expected);
      EXPECT_LT(error, 0.5 * without) << samples << " samples, frame " << i;
    }
    EXPECT_GT(detailed.report().primary_rays, drawn.report().primary_rays);
    EXPECT_LT(detailed.report().primary_rays, whole.report().primary_rays * 3 / 4);
  }
}

TEST(SphereKernel, TheSkyAndFloorsUnderLiteralEdgesAreKept) {
  const auto scene = frame_of_text(R"({
    "sky": 1, "far": 1000, "materials": {"white": {"color": 0.5}},
    "scene": {"type": "plane", "normal": [0, 1, 0], "at": [0, -1.5, 0], "material": "white"}
  })");
  View view = view_of(*scene);
  Config config;
  config.detail = kNoDetail;
  config.mask.rule = MaskRule::Literal;
  config.mask.fovea = Degrees{0.5};
  config.mask.outer = Degrees{1.0};
  config.refresh = Refresh::EveryFourth;
  Session session(config);
  session.next(*scene, view);
  const std::uint64_t first = session.report().primary_rays;
  session.next(*scene, view);
  constexpr std::uint64_t kLow = kSide * kSide / 16;
  EXPECT_LT(session.report().primary_rays - kLow, 3 * (first - kLow) / 4);
}

TEST(SphereKernel, ANewHistoryKeepsNothing) {
  const auto scene = frame_of("primitives");
  const View view = view_of(*scene);
  Config config;
  Session every(config);
  config.refresh = Refresh::EveryFourth;
  Session first(config);
  every.next(*scene, view), first.next(*scene, view);
  EXPECT_EQ(first.report().primary_rays, every.report().primary_rays);
}

TEST(SphereKernel, AFovealGridIsTracedWhole) {
  const auto scene = frame_of("primitives");
  View view = view_of(*scene);
  view.grid = foveation::make_foveal_grid({math::symmetric_fov(Degrees{90.0}, 1.0), 600, 600},
                                          view.gaze, foveation::RateModel{});
  const auto cells = static_cast<std::uint64_t>(view.grid.width()) * view.grid.height();
  Session session{Config{}};
  session.next(*scene, view);
  // Cells beside the fovea that are smaller than four of the smallest may yet be thinned out.
  EXPECT_GT(session.report().primary_rays, cells * 6 / 10);
}

TEST(SphereKernel, ShadingPointsRepeatsThePicture) {
  const auto scene = frame_of("primitives");
  const View view = view_of(*scene, 32);
  Config config = unfoveated(Tracing::Pyramid);
  config.mode = Mode::Exact;
  Session session(config);
  const ViewBuffers& planes = session.next(*scene, view);
  TileScheduler scheduler(1);
  for (int x = 0; x < 32; x += 5) {
    const Vec3 ray = view.grid.ray(x, 20);
    if (std::isinf(planes.depth_m(x, 20))) continue;
    SurfacePoint point;
    point.position = view.world_from_view.transform_point(
        static_cast<double>(planes.depth_m(x, 20)) * DVec3(ray));
    point.geometric_normal = planes.normal(x, 20);
    point.to_eye = Vec3(glm::normalize(view.world_from_view.position - point.position));
    point.instance = planes.surface_id(x, 20) - 1;
    Rgb shaded{0.0F};
    SphereKernel(config).shade({&point, 1}, *scene, scheduler, {&shaded, 1});
    EXPECT_NEAR(shaded.x, planes.radiance(x, 20).x, 1e-3F);
  }
}

TEST(SphereKernel, NamesItsShortcutsInFastAndHasNoneInExact) {
  const auto scene = frame_of_text(kBall);
  const View view = view_of(*scene, 16);
  KernelOptions options;
  options.mode = Mode::Exact;
  Session exact(make_config(options));
  exact.next(*scene, view);
  EXPECT_TRUE(exact.report().biased_shortcuts.empty());
  Config config;
  config.refresh = Refresh::EverySecond;
  Session fast(config);
  fast.next(*scene, view);
  EXPECT_EQ(fast.report().biased_shortcuts.size(), 5U);
}

TEST(SphereKernel, TinyPicturesAndTheEyeInASolidAreDefined) {
  const auto scene = frame_of_text(kBall);
  for (const int side : {1, 2, 3, 7}) {
    View view = view_of(*scene, side);
    Session session{Config{}};
    for (const Rgb& value : session.next(*scene, view).radiance.pixels())
      EXPECT_TRUE(math::is_finite(value));
    view.world_from_view.position = {0.0, 0.0, -4.0};
    const ViewBuffers& inside = session.next(*scene, view);
    EXPECT_NEAR(inside.depth_m(0, 0), 0.0F, 1e-6F);
    EXPECT_TRUE(math::is_finite(inside.radiance(0, 0)));
  }
}

/// A floor under a ball that floats over the origin, the sun in the zenith; no sky.
constexpr const char* kBallOverFloor = R"({
  "sky": 0, "far": 50,
  "materials": {"white": {"color": 0.5}},
  "suns": [{"direction": [0, -1, 0], "irradiance": 3}],
  "scene": {"type": "union", "material": "white", "of": [
    {"type": "plane", "normal": [0, 1, 0]},
    {"type": "sphere", "radius": 0.5, "at": [0, 2, 0]}]}
})";

/// Radiance of the floor `x` to the side of the origin, seen from above it.
float floor_radiance(const SceneFrame& scene, const Config& config, double x) {
  View view = view_of(scene, 9, 10.0);
  view.world_from_view = math::look_at({x, 0.3, 0.4}, {x, 0.0, 0.0}, {0, 1, 0});
  Session session(config);
  return session.next(scene, view).radiance(4, 4).x;
}

TEST(SphereKernel, ShadowsLieWhereTheSunIsHidden) {
  const auto scene = frame_of_text(kBallOverFloor);
  const float lit = 3.0F * 0.5F / 3.14159265F;
  Config config = unfoveated(Tracing::Pyramid);
  EXPECT_NEAR(floor_radiance(*scene, config, 0.0), lit, 1e-3F);
  config.lighting.shadows = Shadows::Hard;
  EXPECT_EQ(floor_radiance(*scene, config, 0.0), 0.0F);
  EXPECT_EQ(floor_radiance(*scene, config, 0.45), 0.0F);
  EXPECT_NEAR(floor_radiance(*scene, config, 0.55), lit, 1e-3F);
  config.lighting.shadows = Shadows::Soft;
  config.lighting.light_radius = Degrees{5.0};
  EXPECT_EQ(floor_radiance(*scene, config, 0.0), 0.0F);
  EXPECT_GT(floor_radiance(*scene, config, 0.58), 0.05F * lit);
  EXPECT_LT(floor_radiance(*scene, config, 0.58), 0.95F * lit);
  EXPECT_NEAR(floor_radiance(*scene, config, 1.5), lit, 1e-3F);
}

// The cliff of scene `temple` was black: its distances, which a large bound divides, were taken for
// those of something in the way.
TEST(SphereKernel, ShadowRaysLeaveSurfacesOfALargeBound) {
  for (const char* bound : {"1", "3", "8"}) {
    const std::string text = std::string(R"({
      "sky": 1, "far": 50,
      "materials": {"white": {"color": 0.5}},
      "suns": [{"direction": [0, -1, 0], "irradiance": 3}],
      "scene": {"type": "plane", "normal": [0, 1, 0], "material": "white", "lipschitz": )") +
                             bound + "}}";
    const auto scene = frame_of_text(text.c_str());
    Config config = unfoveated(Tracing::Pyramid);
    config.lighting.shadows = Shadows::Hard;
    config.lighting.sky = SkyLight::Traced;
    config.lighting.sky_samples = 64;
    const float lit = 0.5F + 3.0F * 0.5F / 3.14159265F;
    EXPECT_NEAR(floor_radiance(*scene, config, 0.0), lit, 0.02F * lit) << bound;
  }
}

TEST(SphereKernel, CountsTheRaysToLightsAndSky) {
  const auto scene = frame_of_text(R"({
    "sky": 1, "far": 50,
    "materials": {"white": {"color": 0.5}},
    "suns": [{"direction": [0, -1, 0], "irradiance": 3}],
    "scene": {"type": "plane", "normal": [0, 1, 0], "material": "white"}
  })");
  View view = view_of(*scene, 16, 30.0);
  view.world_from_view = math::look_at({0.0, 2.0, 0.1}, {0.0, 0.0, 0.0}, {0, 1, 0});
  KernelOptions options;
  options.mode = Mode::Exact;
  options.samples_per_cell = 2;
  options.ambient_samples = 3;
  Session exact(make_config(options));
  exact.next(*scene, view);
  constexpr std::uint64_t kSamples = 16 * 16 * 2;  // each meets the floor, which the sun lights
  EXPECT_EQ(exact.report().primary_rays, kSamples);
  EXPECT_EQ(exact.report().shadow_rays, kSamples * (1 + 3));
  Session plain(unfoveated(Tracing::Pyramid, 2));
  plain.next(*scene, view);
  EXPECT_EQ(plain.report().shadow_rays, 0U);
  EXPECT_GT(exact.report().field_evaluations, plain.report().field_evaluations);
}

TEST(SphereKernel, ExactHasTheSameBitsForAnyNumberOfThreads) {
  const auto scene = frame_of("temple", 0.5);
  const View view = view_of(*scene, 144);  // tiles of two sizes
  KernelOptions options;
  options.mode = Mode::Exact;
  options.ambient_samples = 1;
  Session one(make_config(options), 1), three(make_config(options), 3);
  EXPECT_TRUE(same_bits(one.next(*scene, view).radiance, three.next(*scene, view).radiance));
  EXPECT_EQ(one.report().shadow_rays, three.report().shadow_rays);
  EXPECT_EQ(one.report().field_evaluations, three.report().field_evaluations);
}

TEST(SphereKernel, BesideAWallHalfTheSkyIsHidden) {
  const auto scene = frame_of_text(R"({
    "sky": 1, "far": 1000,
    "materials": {"white": {"color": 0.5}},
    "scene": {"type": "union", "material": "white", "of": [
      {"type": "plane", "normal": [0, 1, 0]},
      {"type": "box", "half_size": [1, 400, 400], "at": [-1, 0, 0]}]}
  })");
  Config config = unfoveated(Tracing::Pyramid);
  EXPECT_NEAR(floor_radiance(*scene, config, 0.02), 0.5F, 1e-4F);
  config.lighting.sky = SkyLight::Traced;
  config.lighting.sky_samples = 1024;  // a (0, m, 2)-net: the share is exact to some of 1024
  EXPECT_NEAR(floor_radiance(*scene, config, 0.02), 0.25F, 0.01F);
  config.lighting.sky = SkyLight::Near;
  EXPECT_LT(floor_radiance(*scene, config, 0.02), 0.3F);
  EXPECT_NEAR(floor_radiance(*scene, config, 300.0), 0.5F, 1e-3F);
  config.lighting.sky = SkyLight::None;
  EXPECT_EQ(floor_radiance(*scene, config, 0.02), 0.0F);
}

}  // namespace
}  // namespace macula::kernels::sphere
