// Light that surfaces have reflected once, as virtual lights in the tree of lamps.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "server/kernels/lightcuts/lightcuts_kernel.h"
#include "server/kernels/ray/ray_kernel.h"
#include "server/kernels/scene_timeline.h"
#include "server/kernels/vpl/virtual_lights.h"
#include "tests/conformance/test_scenes.h"

namespace macula::kernels::lightcuts {
namespace {

constexpr int kSide = 16;
constexpr vpl::Config kRays{6, 0, shading::MaterialModel::Lambert, 5};

/// A closed room with one lamp and nothing else that shines.
std::shared_ptr<const scene::Scene> room() {
  scene::Scene scene = test::closed_room();
  scene.materials[2].emission = Rgb{0.0F};
  scene.settings.ambient = Rgb{0.0F};
  scene.lights.resize(1);
  scene.lights[0] = {};
  scene.lights[0].position = {0.3, 1.0, -2.0};
  scene.lights[0].intensity = Rgb{2.0F, 1.5F, 1.0F};
  return std::make_shared<const scene::Scene>(std::move(scene));
}

std::vector<lights::VirtualPointLight> bounced(const SceneFrame& frame) {
  scheduling::TileScheduler scheduler;
  return vpl::make_virtual_lights(frame, kRays, scheduler).lights;
}

std::shared_ptr<const SceneFrame> lit_room(BouncedLight bounced) {
  const auto scene = room();
  const scene::ScenePlan plan(scene::facts_of(*scene), {.kernel = "lightcuts"});
  return *(*SceneTimeline::create(scene, plan, std::move(bounced)))->at({});
}

Plane<Rgb> rendered(const Kernel& kernel, const SceneFrame& scene, std::uint64_t seed) {
  const foveation::Display display = test::display(kSide, 100.0);
  const View view = test::view_on(foveation::make_uniform_grid(display));
  const FoveationMap map{{{view.grid, view.gaze, display.pixel_tangent()}}, {}};
  scheduling::TileScheduler scheduler;
  History history;
  FrameBuffers out;
  kernel.render({{&view, 1}, map, 0, seed}, scene, history, scheduler, out);
  return std::move(out.views.front().radiance);
}

KernelOptions exact() {
  KernelOptions options;
  options.mode = Mode::Exact;
  options.jitter = false;
  options.lambert_only = true;
  return options;
}

/// Every lamp and every virtual light asked by a ray of its own.
Plane<Rgb> brute_force(const SceneFrame& scene,
                       const std::vector<lights::VirtualPointLight>& lights) {
  const lights::VirtualLightTable table(lights, 1, 0.0F);
  ray::Config config = ray::make_config(exact());
  config.virtual_lights.lights = &table;
  return rendered(ray::RayKernel(config), scene, 1);
}

Plane<Rgb> by_cuts(const SceneFrame& scene, int nodes, std::uint64_t seed) {
  KernelOptions options = exact();
  options.area_light_samples = nodes;
  return rendered(LightcutsKernel(make_config(options)), scene, seed);
}

double mean(const Plane<Rgb>& picture) {
  double sum = 0.0;
  for (const Rgb& c : picture.pixels()) sum += static_cast<double>(image::luminance(c));
  return sum / static_cast<double>(picture.size());
}

TEST(BouncedLight, StandsInTheTreeBehindTheLampsWithItsFlux) {
  const auto plain = lit_room({});
  const auto lit = lit_room(bounced);
  const auto lights = bounced(*plain);
  ASSERT_GT(lights.size(), 30U);
  ASSERT_EQ(plain->placed_lights().size(), 1U);
  ASSERT_EQ(lit->placed_lights().size(), 1U + lights.size());
  double flux = 0.0;
  for (const auto& light : lights) flux += static_cast<double>(image::luminance(light.flux));
  const double tree = lit->placed_lights().tree().node(1).bounds.intensity -
                      plain->placed_lights().tree().node(1).bounds.intensity;
  EXPECT_NEAR(tree, flux / std::numbers::pi, 1e-5 * flux);
}

TEST(BouncedLight, CutsOfAllLightsEqualBruteForce) {
  const auto scene = lit_room(bounced);
  const auto lights = bounced(*scene);
  const auto truth = brute_force(*scene, lights);
  const auto cut = by_cuts(*scene, static_cast<int>(lights.size()) + 1, 1);
  double worst = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const double wanted = static_cast<double>(image::luminance(truth.pixels()[i]));
    const double got = static_cast<double>(image::luminance(cut.pixels()[i]));
    worst = std::max(worst, std::abs(got - wanted) / (wanted + 1e-3));
  }
  EXPECT_LT(worst, 1e-3);
  // And it is no small part of the picture that is equal.
  const auto lamps_alone = brute_force(*lit_room({}), {});
  EXPECT_GT(mean(truth), 1.1 * mean(lamps_alone));
}

TEST(BouncedLight, TheMeanOfFewNodesIsBruteForce) {
  const auto scene = lit_room(bounced);
  const double truth = mean(brute_force(*scene, bounced(*scene)));
  constexpr int kSeeds = 48;
  double sum = 0.0, squares = 0.0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const double value = mean(by_cuts(*scene, 3, static_cast<std::uint64_t>(seed)));
    sum += value, squares += value * value;
  }
  const double found = sum / kSeeds;
  const double error = std::sqrt(std::max(squares / kSeeds - found * found, 0.0) / kSeeds);
  EXPECT_NEAR(found, truth, 4.0 * error + 1e-5 * truth);
  EXPECT_LT(error, 0.02 * truth) << "a mean as uncertain as this would show nothing";
  const double lamps_alone = mean(brute_force(*lit_room({}), {}));
  EXPECT_GT(std::abs(found - lamps_alone), 4.0 * error) << "without bounced light it must fail";
}

}  // namespace
}  // namespace macula::kernels::lightcuts
