#include "server/kernels/lightcuts/lightcuts_kernel.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "server/kernels/ray/ray_kernel.h"
#include "server/scene/load.h"
#include "tests/conformance/test_scenes.h"
#include "tests/server/lights/tree_oracle.h"

namespace macula::kernels::lightcuts {
namespace {

constexpr int kSide = 24;

/// A closed room of 4 m lit by lamps of many strengths below its ceiling and by nothing else.
std::shared_ptr<const SceneFrame> room_of_lamps(int count) {
  scene::Scene scene = test::closed_room();
  scene.materials[2].emission = Rgb{0.0F};
  scene.settings.ambient = Rgb{0.0F};
  scene.lights.clear();
  lights::test::Random random(3);
  for (int i = 0; i < count; ++i) {
    const double x = 3.6 * random.next() - 1.8, y = 1.2 + 0.6 * random.next();
    scene::Light lamp;
    lamp.position = {x, y, -0.5 - 3.0 * random.next()};
    lamp.intensity = Rgb{static_cast<float>(0.02 * std::exp(3.0 * random.next()))};
    scene.lights.push_back(lamp);
  }
  return test::frame_of(std::move(scene));
}

/// One pixel stands for five degrees; the gaze is in the middle.
struct Shown {
  foveation::Display display = test::display(kSide, 120.0);
  View view = test::view_on(foveation::make_uniform_grid(display));
  FoveationMap map{{{view.grid, view.gaze, display.pixel_tangent()}}, {}};

  FrameRequest request(std::uint64_t seed) const { return {{&view, 1}, map, 0, seed}; }
};

Config perceived() {
  KernelOptions options;
  options.jitter = false;  // lights alone are left to chance
  options.light_share = LightShare::Perceived;
  Config config = make_config(options);
  config.most_nodes = 12;
  config.source = LightSource::LowResolution;
  config.denoise = Denoise::No;
  return config;
}

struct Rendered {
  Plane<Rgb> radiance;
  FrameReport report;
};
Rendered rendered(const Kernel& kernel, const SceneFrame& scene, const FrameRequest& request,
                  TileScheduler& scheduler) {
  History history;
  FrameBuffers out;
  FrameReport report = kernel.render(request, scene, history, scheduler, out);
  return {std::move(out.views.front().radiance), std::move(report)};
}

bool same_bits(const Plane<Rgb>& a, const Plane<Rgb>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Rgb)) == 0;
}

TEST(LightcutsKernel, WhereNothingMayGoUnseenItIsTheUniformKernel) {
  const auto scene = room_of_lamps(60);
  const Shown shown;
  TileScheduler scheduler;
  Config config = perceived();
  config.perception.alpha = 0.0F;
  const auto full = rendered(LightcutsKernel(config), *scene, shown.request(1), scheduler);
  config.sizes = CutSizes::Uniform;
  config.ray.area_light_samples = config.most_nodes;
  const auto uniform = rendered(LightcutsKernel(config), *scene, shown.request(1), scheduler);
  EXPECT_TRUE(same_bits(full.radiance, uniform.radiance));
}

TEST(LightcutsKernel, LightsDistanceFieldsAsTheUniformKernelDoes) {
  const auto loaded = scene::load_scene("columns");
  ASSERT_TRUE(loaded);
  const auto scene = SceneFrame::create(*loaded);
  ASSERT_TRUE(scene);
  ASSERT_GT((*scene)->placed_lights().size(), 0U);
  const Shown shown;
  TileScheduler scheduler;
  Config config = perceived();
  config.perception.alpha = 0.0F;
  const auto full = rendered(LightcutsKernel(config), **scene, shown.request(1), scheduler);
  config.sizes = CutSizes::Uniform;
  config.ray.area_light_samples = config.most_nodes;
  const auto uniform = rendered(LightcutsKernel(config), **scene, shown.request(1), scheduler);
  EXPECT_TRUE(same_bits(full.radiance, uniform.radiance));
}

TEST(LightcutsKernel, AsksFewerLightsWhereTheEyeSeesLess) {
  const auto scene = room_of_lamps(60);
  const Shown shown;
  TileScheduler scheduler;
  Config config = perceived();
  config.low_nodes = 0;  // three by three cells would see contrast everywhere
  const LightPlan plan = plan_lights(shown.request(1), *scene, config, scheduler);
  const Plane<std::uint16_t>& nodes = plan.cut_nodes.front();
  int gaze = 0, rim = 0;
  for (int y = 10; y < 14; ++y) {
    for (int x = 10; x < 14; ++x) gaze += nodes(x, y);
    for (int x = 0; x < 4; ++x) rim += nodes(x, y);
  }
  EXPECT_GT(gaze, 2 * rim);
  Config uniform = config;
  uniform.sizes = CutSizes::Uniform;
  uniform.ray.area_light_samples = config.most_nodes;
  const auto many = rendered(LightcutsKernel(uniform), *scene, shown.request(1), scheduler);
  const auto few = rendered(LightcutsKernel(config), *scene, shown.request(1), scheduler);
  EXPECT_LT(2 * few.report.shadow_rays, many.report.shadow_rays);
  EXPECT_EQ(few.report.non_finite_samples, 0U);
}

TEST(LightcutsKernel, TheMeanOfCutsIsTheOneThatWasWanted) {
  const auto scene = room_of_lamps(60);
  const Shown shown;
  TileScheduler scheduler;
  Config config = perceived();
  config.mean_nodes = 3.0;
  const LightPlan plan = plan_lights(shown.request(1), *scene, config, scheduler);
  double sum = 0.0;
  for (const std::uint16_t n : plan.cut_nodes.front().pixels()) sum += n;
  EXPECT_NEAR(sum / (kSide * kSide), 3.0, 0.1);
}

TEST(LightcutsKernel, TheSamePictureComesFromAnyNumberOfThreads) {
  const auto scene = room_of_lamps(60);
  const Shown shown;
  TileScheduler one(1), two(2);
  const LightcutsKernel kernel(perceived());
  EXPECT_TRUE(same_bits(rendered(kernel, *scene, shown.request(7), one).radiance,
                        rendered(kernel, *scene, shown.request(7), two).radiance));
}

/// Cells whose mean over `frames` is more than 4.5 standard errors from `gain` x the truth.
int cells_off(const std::vector<Plane<Rgb>>& frames, const Plane<Rgb>& truth, double gain) {
  int off = 0;
  const auto n = static_cast<double>(frames.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    double sum = 0.0, square = 0.0;
    for (const Plane<Rgb>& frame : frames) {
      const double value = static_cast<double>(frame.pixels()[i].y);
      sum += value, square += value * value;
    }
    const double mean = sum / n, error = std::sqrt(std::max(square / n - mean * mean, 0.0) / n);
    const double wanted = gain * static_cast<double>(truth.pixels()[i].y);
    off += std::abs(mean - wanted) > 4.5 * error + 1e-4 * wanted;
  }
  return off;
}

/// T-SLC-1 with cuts of perceived sizes, which a random picture decides, and T-SLC-2 with lights
/// that another picture drew.
TEST(LightcutsKernel, PerceivedSizesOfCutsAndTakenLightsLeaveTheMeanUnchanged) {
  const auto scene = room_of_lamps(40);
  const Shown shown;
  TileScheduler scheduler;
  Config config = perceived();
  config.low_resolution = 4;
  for (const LightSource source : {LightSource::Walks, LightSource::LowResolution}) {
    config.source = source;
    const LightcutsKernel kernel(config);
    std::vector<Plane<Rgb>> frames;
    FrameReport work;
    for (std::uint64_t seed = 0; seed < 512; ++seed) {
      auto frame = rendered(kernel, *scene, shown.request(seed), scheduler);
      frames.push_back(std::move(frame.radiance));
      work += frame.report;
    }
    EXPECT_EQ(5 * work.taken_nodes > work.walked_nodes, source == LightSource::LowResolution);
    Config every = config;
    every.ray.lights = ray::LightChoice::Every;
    const auto truth =
        rendered(ray::RayKernel(every.ray), *scene, shown.request(0), scheduler).radiance;
    EXPECT_LE(cells_off(frames, truth, 1.0), 3);
    EXPECT_GT(cells_off(frames, truth, 0.97), 50) << "3 % of bias would be seen";
  }
}

/// The last of three frames, the head turned by a pixel's tenth in each.
Rendered third_frame(const LightcutsKernel& kernel, const SceneFrame& scene, std::uint64_t seed,
                     TileScheduler& scheduler) {
  History history;
  Rendered last;
  for (std::uint64_t k = 0; k < 3; ++k) {
    Shown shown;
    const double angle = 0.008 * static_cast<double>(k) - 0.016;
    shown.view.world_from_view.rotation = DQuat(std::cos(angle), 0.0, std::sin(angle), 0.0);
    FrameBuffers out;
    FrameReport report =
        kernel.render({{&shown.view, 1}, shown.map, k, seed}, scene, history, scheduler, out);
    last = {std::move(out.views.front().radiance), std::move(report)};
  }
  return last;
}

/// T-RIS in pictures: what is kept of earlier frames does not change the mean of this one.
TEST(LightcutsKernel, ReservoirsLeaveTheMeanUnchanged) {
  const auto scene = room_of_lamps(40);
  TileScheduler scheduler;
  Config config = perceived();
  config.low_resolution = 4;
  config.source = LightSource::Reservoirs;
  config.reservoirs.traces_neighbours = true;
  config.reservoirs.blends_colours = false;
  const LightcutsKernel kernel(config);
  std::vector<Plane<Rgb>> frames;
  for (std::uint64_t seed = 0; seed < 160; ++seed) {
    frames.push_back(third_frame(kernel, *scene, seed, scheduler).radiance);
  }
  config.ray.lights = ray::LightChoice::Every;
  const auto truth =
      rendered(ray::RayKernel(config.ray), *scene, Shown().request(0), scheduler).radiance;
  EXPECT_LE(cells_off(frames, truth, 1.0), 3);
  EXPECT_GT(cells_off(frames, truth, 0.95), 50) << "5 % of bias would be seen";
}

/// Variance of cells over seeds, summed.
double variance(const LightcutsKernel& kernel, const SceneFrame& scene, TileScheduler& scheduler) {
  constexpr int kSeeds = 24;
  std::vector<double> sum(kSide * kSide), square(kSide * kSide);
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const auto picture = third_frame(kernel, scene, seed, scheduler).radiance;
    for (std::size_t i = 0; i < sum.size(); ++i) {
      const auto value = static_cast<double>(picture.pixels()[i].y);
      sum[i] += value, square[i] += value * value;
    }
  }
  double all = 0.0;
  for (std::size_t i = 0; i < sum.size(); ++i)
    all += square[i] / kSeeds - std::pow(sum[i] / kSeeds, 2);
  return all;
}

TEST(LightcutsKernel, MemoryAndSmoothingEachTakeNoiseAway) {
  const auto scene = room_of_lamps(40);
  TileScheduler scheduler;
  Config config = perceived();
  config.low_resolution = 4;
  const double taken = variance(LightcutsKernel(config), *scene, scheduler);
  config.source = LightSource::Reservoirs;
  const double kept = variance(LightcutsKernel(config), *scene, scheduler);
  config.denoise = Denoise::Yes;
  const double smoothed = variance(LightcutsKernel(config), *scene, scheduler);
  EXPECT_LT(kept, 0.7 * taken);
  EXPECT_LT(smoothed, 0.7 * kept);
}

/// What neighbours take from one low pixel they err alike, which smoothing would keep.
TEST(LightcutsKernel, LargeCutsTakeNothingFromOthersWhereTheyAreSmoothed) {
  const auto scene = room_of_lamps(40);
  TileScheduler scheduler;
  const auto taken = [&](int nodes, Denoise denoise) {
    Config config = perceived();
    config.low_resolution = 4, config.least_nodes = config.most_nodes = nodes;
    config.denoise = denoise;
    return third_frame(LightcutsKernel(config), *scene, 3, scheduler).report.taken_nodes;
  };
  EXPECT_GT(taken(12, Denoise::No), 0U);
  EXPECT_EQ(taken(12, Denoise::Yes), 0U);
  EXPECT_GT(taken(4, Denoise::Yes), 0U);
}

/// Both views of a request are what each is alone, memory included.
TEST(LightcutsKernel, WithoutReuseTwoViewsAreLitAsEachAlone) {
  const auto scene = room_of_lamps(60);
  TileScheduler scheduler;
  Config config = perceived();
  config.source = LightSource::Reservoirs;
  config.denoise = Denoise::Yes;
  config.stereo = StereoReuse::No;
  const LightcutsKernel kernel(config);
  const Shown shown;
  View right = shown.view;
  right.world_from_view.position.x += 0.06;
  const std::vector<View> both{shown.view, right};
  const auto input = [&](const View& view) {
    return FoveationMap::ViewInput{view.grid, view.gaze, shown.display.pixel_tangent()};
  };
  const FoveationMap map({input(shown.view), input(right)}, {});
  const auto last_of_two = [&](std::span<const View> views, const FoveationMap& foveation) {
    History history;
    FrameBuffers out;
    for (std::uint64_t k = 0; k < 2; ++k) {
      kernel.render({views, foveation, k, 5}, *scene, history, scheduler, out);
    }
    return out;
  };
  const FrameBuffers together = last_of_two(both, map);
  for (std::size_t v = 0; v < 2; ++v) {
    const FoveationMap alone({input(both[v])}, {});
    const FrameBuffers one = last_of_two({&both[v], 1}, alone);
    EXPECT_TRUE(same_bits(together.views[v].radiance, one.views[0].radiance)) << v;
  }
}

TEST(LightcutsKernel, ReservoirsDoNotDependOnThreads) {
  const auto scene = room_of_lamps(60);
  TileScheduler one(1), two(2);
  Config config = perceived();
  config.source = LightSource::Reservoirs;
  config.denoise = Denoise::Yes;
  const LightcutsKernel kernel(config);
  EXPECT_TRUE(same_bits(third_frame(kernel, *scene, 7, one).radiance,
                        third_frame(kernel, *scene, 7, two).radiance));
}

}  // namespace
}  // namespace macula::kernels::lightcuts
