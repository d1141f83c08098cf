// What every kernel of the table must do, whatever its method.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <ctime>
#include <limits>
#include <map>
#include <vector>

#include "shared/base/text.h"
#include "tests/conformance/test_scenes.h"

namespace macula {
namespace {

using kernels::KernelOptions;
using kernels::Mode;
using kernels::TileScheduler;
using test::Render;

KernelOptions exact(int samples, int light_samples = 2) {
  KernelOptions options;
  options.mode = Mode::Exact;
  options.bounces = 0;
  options.samples_per_cell = samples;
  options.area_light_samples = light_samples;
  options.ambient_samples = light_samples;
  return options;
}

bool same_bits(const Rgb& a, const Rgb& b) {
  return std::memcmp(&a, &b, sizeof(Rgb)) == 0;
}

class KernelConformance : public testing::TestWithParam<std::string_view> {
 protected:
  std::string kernel() const { return std::string(GetParam()); }
};

/// Means over 8x8 blocks of cells of two pictures differ by less than 4.5 of their own standard
/// errors (each plane's variance is of its cells' means), up to rounding.
double worst_block_deviation(const Render& a, const Render& b, float gain_of_a = 1.0F) {
  constexpr int kBlock = 8;
  const auto& pa = a.planes();
  const auto& pb = b.planes();
  double worst = 0.0;
  for (int by = 0; by + kBlock <= pa.radiance.height(); by += kBlock) {
    for (int bx = 0; bx + kBlock <= pa.radiance.width(); bx += kBlock) {
      double difference = 0.0, variance = 0.0, level = 0.0;
      for (int y = by; y < by + kBlock; ++y) {
        for (int x = bx; x < bx + kBlock; ++x) {
          const double la = gain_of_a * image::luminance(pa.radiance(x, y));
          difference += la - image::luminance(pb.radiance(x, y));
          variance += pa.variance(x, y) + pb.variance(x, y);
          level += la;
        }
      }
      worst = std::max(worst, std::abs(difference) / (std::sqrt(variance) + 1e-5 * level + 1e-9));
    }
  }
  return worst;
}

TEST_P(KernelConformance, AtFullRateItsMeanIsThatOfBruteForce) {
  const auto scene = test::frame_of(test::small_room());
  const auto view = test::view_on(foveation::make_uniform_grid(test::display(24)));
  TileScheduler scheduler;
  const Render own = test::render(kernel(), exact(256, 4), *scene, view, scheduler, 7);
  const Render brute = test::render("brute", exact(256, 4), *scene, view, scheduler, 8);
  EXPECT_LT(worst_block_deviation(own, brute), 4.5);
  EXPECT_GT(worst_block_deviation(own, brute, 1.03F), 4.5) << "a 3 % bias must be seen";
}

TEST_P(KernelConformance, AConvexBallInAUniformEnvironmentShowsExactlyItsAlbedo) {
  const auto scene = test::frame_of(test::furnace(0.5F));
  const auto view = test::view_on(foveation::make_uniform_grid(test::display(20)));
  TileScheduler scheduler;
  KernelOptions options = exact(1);
  options.jitter = false;
  const Render furnace = test::render(kernel(), options, *scene, view, scheduler);
  int hits = 0;
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 20; ++x) {
      const bool hit = std::isfinite(furnace.planes().depth_m(x, y));
      hits += hit;
      EXPECT_FLOAT_EQ(furnace.planes().radiance(x, y).x, hit ? 0.5F : 1.0F);
    }
  }
  EXPECT_GT(hits, 50);
  EXPECT_LT(hits, 350);
}

TEST_P(KernelConformance, AWallAcrossTheViewHasOneDepthNormalAndIdentity) {
  scene::Scene wall;
  wall.materials.resize(1);
  wall.materials[0].base_color = {0.25F, 0.5F, 0.75F};
  test::add_quad(wall, {-10, -10, -2}, {20, 0, 0}, {0, 20, 0}, 0);
  const auto scene = test::frame_of(std::move(wall));
  const auto view = test::view_on(foveation::make_uniform_grid(test::display(17, 90.0)));
  TileScheduler scheduler;
  const Render render = test::render(kernel(), exact(1), *scene, view, scheduler);
  for (int y = 0; y < 17; ++y) {
    for (int x = 0; x < 17; ++x) {
      EXPECT_NEAR(render.planes().depth_m(x, y), 2.0F, 1e-5F);
      EXPECT_EQ(render.planes().surface_id(x, y), 1U);
      EXPECT_NEAR(render.planes().normal(x, y).z, 1.0F, 1e-6F);
      EXPECT_EQ(render.planes().albedo(x, y), Rgb(0.25F, 0.5F, 0.75F));
    }
  }
}

constexpr float kPaneAlpha = 0.3F;
/// A wall of radiance 1 behind two panes of alpha 0.3 and radiance 4; or, dark itself, lit through
/// them by a sun, which gives it radiance 1 where nothing is in the way, and seen past them.
enum class Panes { InSight, InLight };
scene::Scene wall_behind_panes(Panes where) {
  scene::Scene scene;
  scene.materials.resize(2);
  scene.materials[0].specular = scene.materials[1].specular = 0.0F;
  scene.materials[1].alpha_mode = scene::AlphaMode::Blend;
  scene.materials[1].alpha = kPaneAlpha;
  test::add_quad(scene, {-9, -9, -4}, {18, 0, 0}, {0, 18, 0}, 0);
  if (where == Panes::InSight) {
    scene.materials[0].emission = Rgb{1.0F};
    scene.materials[1].emission = Rgb{4.0F};
    scene.materials[0].base_color = scene.materials[1].base_color = Rgb{0.0F};
    test::add_quad(scene, {-9, -9, -2}, {18, 0, 0}, {0, 18, 0}, 1);
    test::add_quad(scene, {-9, -9, -3}, {18, 0, 0}, {0, 18, 0}, 1);
    return scene;
  }
  // The view looks under the panes; the light comes down at 45 degrees.
  test::add_quad(scene, {-9, 3, -3.5F}, {18, 0, 0}, {0, 0, 6}, 1);
  test::add_quad(scene, {-9, 4, -3.5F}, {18, 0, 0}, {0, 0, 8}, 1);
  scene::Light sun;
  sun.kind = scene::LightKind::Directional;
  sun.direction = glm::normalize(Vec3{0, -1, -1});
  sun.intensity = Rgb{3.14159265F * std::sqrt(2.0F)};
  scene.lights = {sun};
  return scene;
}
struct Mean {
  double value = 0.0, standard_error = 0.0;
};
Mean mean_of(const Render& render) {
  Mean mean;
  const auto n = static_cast<double>(render.planes().radiance.size());
  for (const Rgb& value : render.planes().radiance.pixels()) mean.value += value.x / n;
  for (const float variance : render.planes().variance.pixels()) mean.standard_error += variance;
  mean.standard_error = std::sqrt(mean.standard_error) / n;
  return mean;
}

TEST_P(KernelConformance, BlendedPanesShowTheMeanOfWhatTheyAreAndWhatTheyLetThrough) {
  const auto view = test::view_on(foveation::make_uniform_grid(test::display(24)));
  TileScheduler scheduler;
  const double a = kPaneAlpha, through = (1.0 - a) * (1.0 - a);
  for (const Panes where : {Panes::InSight, Panes::InLight}) {
    const auto scene = test::frame_of(wall_behind_panes(where));
    const double right = where == Panes::InSight ? 4.0 * (a + (1.0 - a) * a) + through : through;
    const Render exactly = test::render(kernel(), exact(64), *scene, view, scheduler);
    const Mean mean = mean_of(exactly);
    EXPECT_NEAR(mean.value, right, 4.0 * mean.standard_error);
    EXPECT_LT(4.0 * mean.standard_error, 0.05 * right);
    scene::Scene masked = wall_behind_panes(where);
    masked.materials[1].alpha_mode = scene::AlphaMode::Mask;
    const auto twin = test::frame_of(std::move(masked));
    const Mean wrong = mean_of(test::render(kernel(), exact(4), *twin, view, scheduler));
    EXPECT_GT(std::abs(wrong.value - right), 0.2) << "a mask at one half hides nothing";
    TileScheduler one(1);
    const Render again = test::render(kernel(), exact(64), *scene, view, one);
    EXPECT_EQ(0, std::memcmp(exactly.planes().radiance.data(), again.planes().radiance.data(),
                             again.planes().radiance.size() * sizeof(Rgb)));
  }
}

TEST(FastRay, MeetsABlendedSurfaceWithAFixedShareOfItsSamples) {
  const auto view = test::view_on(foveation::make_uniform_grid(test::display(24)));
  TileScheduler scheduler;
  scene::Scene source = wall_behind_panes(Panes::InSight);
  source.instances.pop_back();
  const auto scene = test::frame_of(std::move(source));
  for (const auto& [samples, met] : {std::pair{1, 0.0F}, {4, 0.25F}, {16, 5.0F / 16.0F}}) {
    KernelOptions options = exact(samples);
    options.mode = Mode::Fast;
    const Render fast = test::render("ray", options, *scene, view, scheduler);
    for (const Rgb& value : fast.planes().radiance.pixels()) {
      EXPECT_FLOAT_EQ(value.x, 1.0F + 3.0F * met) << samples << " samples";
    }
    EXPECT_EQ(fast.report.biased_shortcuts.size(), 2U);
  }
}

TEST_P(KernelConformance, OneThreadAndManyGiveTheSameBits) {
  const auto scene = test::frame_of(test::small_room());
  const auto view = test::view_on(foveation::make_uniform_grid(test::display(40)));
  TileScheduler one(1), many(4);
  const Render a = test::render(kernel(), exact(2), *scene, view, one);
  const Render b = test::render(kernel(), exact(2), *scene, view, many);
  EXPECT_EQ(0, std::memcmp(a.planes().radiance.data(), b.planes().radiance.data(),
                           a.planes().radiance.size() * sizeof(Rgb)));
  EXPECT_EQ(0, std::memcmp(a.planes().depth_m.data(), b.planes().depth_m.data(),
                           a.planes().depth_m.size() * sizeof(float)));
  EXPECT_EQ(a.report.shadow_rays, b.report.shadow_rays);
}

TEST_P(KernelConformance, AnotherSeedGivesOtherSamples) {
  const auto scene = test::frame_of(test::small_room());
  const auto view = test::view_on(foveation::make_uniform_grid(test::display(16)));
  TileScheduler scheduler;
  const Render a = test::render(kernel(), exact(1), *scene, view, scheduler, 1);
  const Render b = test::render(kernel(), exact(1), *scene, view, scheduler, 2);
  EXPECT_NE(0, std::memcmp(a.planes().radiance.data(), b.planes().radiance.data(),
                           a.planes().radiance.size() * sizeof(Rgb)));
}

PixelGrid foveal_grid(const foveation::Display& display) {
  return foveation::make_foveal_grid(display, Gaze{}, foveation::RateModel{});
}

TEST_P(KernelConformance, CellsThatTwoGridsShareGetTheSameBits) {
  const auto scene = test::frame_of(test::small_room());
  const auto display = test::display(160, 90.0);
  const auto full = test::view_on(foveation::make_uniform_grid(display));
  const auto foveal = test::view_on(foveal_grid(display));
  TileScheduler scheduler;
  const Render a = test::render(kernel(), exact(1), *scene, full, scheduler);
  const Render b = test::render(kernel(), exact(1), *scene, foveal, scheduler);
  std::map<std::uint64_t, Rgb> known;
  for (int y = 0; y < full.grid.height(); ++y) {
    for (int x = 0; x < full.grid.width(); ++x) {
      known[full.grid.cell_key(x, y)] = a.planes().radiance(x, y);
    }
  }
  int shared = 0, different = 0;
  for (int y = 0; y < foveal.grid.height(); ++y) {
    for (int x = 0; x < foveal.grid.width(); ++x) {
      const auto found = known.find(foveal.grid.cell_key(x, y));
      if (found == known.end()) continue;
      ++shared;
      different += !same_bits(found->second, b.planes().radiance(x, y));
    }
  }
  // At least the disc of 5 degrees around the gaze: about pi (5 x 1.4)^2 cells.
  EXPECT_GT(shared, 150);
  EXPECT_EQ(different, 0);
}

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

double cell_share(const PixelGrid& grid, const PixelGrid& full) {
  return static_cast<double>(grid.width()) * grid.height() /
         (static_cast<double>(full.width()) * full.height());
}

/// A foveal grid of about a quarter of the display's cells: the full-rate disc is widened until
/// then.
PixelGrid quarter_grid(const foveation::Display& display) {
  const PixelGrid full = foveation::make_uniform_grid(display);
  foveation::FovealGridOptions options;
  PixelGrid grid = foveation::make_foveal_grid(display, Gaze{}, foveation::RateModel{}, options);
  while (cell_share(grid, full) < 0.24 && options.full_rate_radius < Degrees{40.0}) {
    options.full_rate_radius = options.full_rate_radius + Degrees{0.5};
    grid = foveation::make_foveal_grid(display, Gaze{}, foveation::RateModel{}, options);
  }
  return grid;
}

// Fewer cells are fewer rays exactly; processor time, the median of interleaved repeats on one
// thread, follows within a margin for the poorer coherence of wide cells.
TEST_P(KernelConformance, AQuarterOfTheCellsCostsLessThanAThirdOfTheTime) {
  const auto scene = test::frame_of(test::closed_room());
  const auto display = test::display(kernel() == "brute" ? 128 : 320, 100.0);
  const auto full = test::view_on(foveation::make_uniform_grid(display));
  const auto foveal = test::view_on(quarter_grid(display));
  const double share = cell_share(foveal.grid, full.grid);
  ASSERT_NEAR(share, 0.25, 0.02);
  TileScheduler scheduler(1);
  std::vector<double> ratios;
  for (int repeat = 0; repeat < 7; ++repeat) {
    const double t0 = cpu_seconds();
    const Render a = test::render(kernel(), exact(1), *scene, full, scheduler);
    const double t1 = cpu_seconds();
    const Render b = test::render(kernel(), exact(1), *scene, foveal, scheduler);
    const double t2 = cpu_seconds();
    ratios.push_back((t1 - t0) / (t2 - t1));
    EXPECT_NEAR(
        static_cast<double>(b.report.primary_rays) / static_cast<double>(a.report.primary_rays),
        share, 1e-9);
  }
  RecordProperty("cpu_ratio", base::concat(median(ratios)));
  RecordProperty("cell_share", base::concat(share));
  EXPECT_GT(median(ratios), 3.0) << "at " << 100.0 * share << " % of the cells";
}

TEST_P(KernelConformance, AStopRequestLeavesTheFrameMarkedAsStopped) {
  const auto scene = test::frame_of(test::small_room());
  const auto view = test::view_on(foveation::make_uniform_grid(test::display(64)));
  TileScheduler scheduler(2);
  std::stop_source source;
  source.request_stop();
  scheduler.set_stop_token(source.get_token());
  const Render render = test::render(kernel(), exact(1), *scene, view, scheduler);
  EXPECT_TRUE(render.report.stopped);
  EXPECT_EQ(render.report.primary_rays, 0U);
}

TEST_P(KernelConformance, AnEmptySceneShowsItsEnvironmentAtInfinity) {
  scene::Scene empty;
  empty.settings.ambient = {0.1F, 0.2F, 0.3F};
  const auto scene = test::frame_of(std::move(empty));
  const auto view = test::view_on(foveation::make_uniform_grid(test::display(5)));
  TileScheduler scheduler;
  const Render render = test::render(kernel(), exact(1), *scene, view, scheduler);
  for (const Rgb& value : render.planes().radiance.pixels()) {
    EXPECT_FLOAT_EQ(value.z, 0.3F);
  }
  for (const float depth : render.planes().depth_m.pixels()) EXPECT_TRUE(std::isinf(depth));
  for (const std::uint32_t id : render.planes().surface_id.pixels()) EXPECT_EQ(id, 0U);
}

TEST_P(KernelConformance, AnEyeInsideSolidGeometryGetsFinitePictures) {
  const auto scene = test::frame_of(test::small_room());
  auto view = test::view_on(foveation::make_uniform_grid(test::display(24)));
  view.world_from_view.position = {0.3, -0.4, -3.0};  // the centre of the ball
  TileScheduler scheduler;
  const Render render = test::render(kernel(), exact(2), *scene, view, scheduler);
  for (const Rgb& value : render.planes().radiance.pixels()) EXPECT_TRUE(math::is_finite(value));
  EXPECT_EQ(render.report.non_finite_samples, 0U);
}

TEST_P(KernelConformance, NonFiniteRadianceBecomesBlackAndIsCounted) {
  scene::Scene broken = test::small_room();
  broken.lights[0].intensity = Rgb{std::numeric_limits<float>::quiet_NaN()};
  const auto scene = test::frame_of(std::move(broken));
  const auto view = test::view_on(foveation::make_uniform_grid(test::display(24)));
  TileScheduler scheduler;
  const Render render = test::render(kernel(), exact(1), *scene, view, scheduler);
  for (const Rgb& value : render.planes().radiance.pixels()) EXPECT_TRUE(math::is_finite(value));
  EXPECT_GT(render.report.non_finite_samples, 0U);
}

TEST_P(KernelConformance, TwoViewsAtOnceAreTheTwoViewsAlone) {
  const auto scene = test::frame_of(test::small_room());
  std::vector<kernels::View> views(2,
                                   test::view_on(foveation::make_uniform_grid(test::display(20))));
  views[1].world_from_view.position.x = 0.065;
  TileScheduler scheduler;
  const auto made = kernels::make_kernel(kernel(), exact(1));
  ASSERT_TRUE(made);
  const FoveationMap map({{views[0].grid, {}, DVec2{1e-3}}, {views[1].grid, {}, DVec2{1e-3}}}, {});
  kernels::FrameBuffers both;
  kernels::History history;
  (*made)->render({views, map, 0, 1}, *scene, history, scheduler, both);
  for (std::size_t v = 0; v < 2; ++v) {
    const Render alone = test::render(kernel(), exact(1), *scene, views[v], scheduler);
    EXPECT_EQ(0, std::memcmp(both.views[v].radiance.data(), alone.planes().radiance.data(),
                             alone.planes().radiance.size() * sizeof(Rgb)));
  }
}

TEST_P(KernelConformance, ShadingAPointOfAFurnaceShowsItsAlbedo) {
  const auto scene = test::frame_of(test::furnace(0.8F));
  TileScheduler scheduler;
  const auto made = kernels::make_kernel(kernel(), exact(1));
  ASSERT_TRUE(made);
  kernels::SurfacePoint point;
  const auto hit = scene->triangles().intersect(
      visibility::Ray{Vec3{0.0F}, Vec3(0.1F, 0.2F, -3.0F), 0.0F, 1e9F});
  ASSERT_TRUE(hit);
  point.instance = hit->instance, point.triangle = hit->triangle;
  point.barycentric = {hit->u, hit->v};
  point.position = scene->surfaces().at(hit->instance, hit->triangle, point.barycentric).position;
  point.geometric_normal = hit->normal;
  point.to_eye = -glm::normalize(Vec3(0.1F, 0.2F, -3.0F));
  Rgb radiance{0.0F};
  (*made)->shade({&point, 1}, *scene, scheduler, {&radiance, 1});
  EXPECT_FLOAT_EQ(radiance.y, 0.8F);
}

std::vector<std::string_view> names() {
  std::vector<std::string_view> list;
  for (const auto& entry : kernels::kernel_table())
    if (kernels::renders(entry, kernels::SceneKind::Triangles)) list.push_back(entry.name);
  return list;
}
INSTANTIATE_TEST_SUITE_P(EveryKernel, KernelConformance, testing::ValuesIn(names()),
                         [](const auto& tested) { return std::string(tested.param); });

}  // namespace
}  // namespace macula
