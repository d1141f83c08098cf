// Kernel `lightcuts` where it is meant for: hundreds of lights.
#include <algorithm>
#include <cmath>

#include "shared/math/hash.h"
#include "tests/conformance/test_scenes.h"

namespace macula {
namespace {

using kernels::KernelOptions;
using kernels::TileScheduler;
using test::Render;

float random(std::uint64_t index, std::uint64_t dimension) {
  return math::unit_float(math::hash_combine(index, dimension));
}

/// A hall of 8 x 3 x 12 m with a ball in it; lights hang below the ceiling.
scene::Scene hall() {
  scene::Scene scene;
  scene.name = "hall";
  scene.materials.resize(3);
  scene.materials[0].base_color = {0.7F, 0.6F, 0.5F};
  scene.materials[0].specular = 0.0F;
  scene.materials[1].base_color = {0.2F, 0.4F, 0.8F};
  scene.materials[1].roughness = 0.6F;
  scene.materials[2].emission = {20.0F, 16.0F, 10.0F};
  test::add_quad(scene, {-4, -1, 0.5F}, {8, 0, 0}, {0, 0, -12}, 0);
  test::add_quad(scene, {-4, -1, -11.5F}, {8, 0, 0}, {0, 3, 0}, 0);
  test::add_sphere(scene, {0.3F, -0.4F, -4}, 0.6F, 12, 1);
  return scene;
}
Vec3 place(std::uint64_t i) {
  return {-3.9F + 7.8F * random(i, 1), 0.2F + 1.7F * random(i, 2), 0.3F - 11.7F * random(i, 3)};
}
scene::Scene hall_of_lamps(std::uint64_t count) {
  scene::Scene scene = hall();
  for (std::uint64_t i = 0; i < count; ++i) {
    scene::Light light;
    light.position = DVec3(place(i));
    light.intensity = Rgb{0.05F + 0.3F * random(i, 4)};
    if (i % 3 == 0) {
      light.kind = scene::LightKind::Spot;
      light.direction = glm::normalize(Vec3{random(i, 5) - 0.5F, -1.0F, random(i, 6) - 0.5F});
      light.inner_cone = Degrees{20.0}, light.outer_cone = Degrees{60.0};
    }
    scene.lights.push_back(light);
  }
  return scene;
}
scene::Scene hall_of_panels(std::uint64_t count) {
  scene::Scene scene = hall();
  for (std::uint64_t i = 0; i < count; ++i) {
    const float side = 0.03F + 0.1F * random(i, 4);
    const Vec3 tilt{random(i, 5) - 0.5F, random(i, 6) - 0.5F, random(i, 7) - 0.5F};
    test::add_quad(scene, place(i), side * glm::normalize(Vec3{1, 0, 0} + tilt),
                   side * glm::normalize(Vec3{0, 0, 1} + tilt), 2);
  }
  return scene;
}

KernelOptions exact(int samples, int light_samples) {
  KernelOptions options;
  options.mode = kernels::Mode::Exact;
  options.samples_per_cell = samples;
  options.area_light_samples = light_samples;
  options.ambient_samples = 0;
  options.jitter = false;  // pictures of the same points: what differs is light
  return options;
}

/// How much brighter `a` is than `b`, in standard errors, over cells that see no lamp; cells are
/// independent and as noisy as they differ.
double excess(const Render& a, const Render& b, double gain_of_a = 1.0) {
  constexpr float kLamp = 2.0F;
  double sum = 0.0, square = 0.0;
  for (std::size_t i = 0; i < a.planes().radiance.size(); ++i) {
    const float lb = image::luminance(b.planes().radiance.pixels()[i]);
    if (lb > kLamp) continue;
    const double d = gain_of_a * image::luminance(a.planes().radiance.pixels()[i]) - lb;
    sum += d, square += d * d;
  }
  return sum / std::sqrt(square);
}

/// Relative variance of a cell by two pictures of independent seeds, summed.
double noise(const Render& a, const Render& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.planes().radiance.size(); ++i) {
    const double la = image::luminance(a.planes().radiance.pixels()[i]);
    const double lb = image::luminance(b.planes().radiance.pixels()[i]);
    sum += 0.5 * (la - lb) * (la - lb) / (1e-4 + la * lb);
  }
  return sum;
}

kernels::View view(int side) {
  return test::view_on(foveation::make_uniform_grid(test::display(side, 75.0)));
}

TEST(ManyLights, AFewNodesGiveAllTheLightOfHundredsOnAverage) {
  TileScheduler scheduler;
  const auto lamps = test::frame_of(hall_of_lamps(200));
  const auto panels = test::frame_of(hall_of_panels(150));
  for (const auto& scene : {lamps, panels}) {
    const Render brute = test::render("brute", exact(64, 64), *scene, view(16), scheduler, 1);
    for (const int nodes : {1, 4, 48}) {
      const Render cuts = test::render("lightcuts", exact(64, nodes), *scene, view(16), scheduler,
                                       static_cast<std::uint64_t>(nodes + 1));
      EXPECT_LT(std::abs(excess(cuts, brute)), 4.0) << nodes;
      EXPECT_EQ(cuts.report.non_finite_samples, 0U);
      if (nodes < 48) continue;
      EXPECT_GT(excess(cuts, brute, 1.03), 4.0) << "3 % too bright must be seen";
    }
  }
}

// T-SLC-4: as many nodes as lamps ask every lamp.
TEST(ManyLights, AsManyNodesAsLampsGiveThePictureOfEveryLamp) {
  const auto scene = test::frame_of(hall_of_lamps(100));
  TileScheduler scheduler;
  const Render every = test::render("ray", exact(1, 1), *scene, view(32), scheduler);
  const Render cuts = test::render("lightcuts", exact(1, 100), *scene, view(32), scheduler);
  double largest = 0.0;
  for (std::size_t i = 0; i < every.planes().radiance.size(); ++i) {
    const Rgb wanted = every.planes().radiance.pixels()[i];
    const Rgb got = cuts.planes().radiance.pixels()[i];
    largest = std::max<double>(largest, glm::length(got - wanted) / (1e-3F + glm::length(wanted)));
  }
  EXPECT_LT(largest, 1e-5);
  EXPECT_LT(cuts.report.shadow_rays, every.report.shadow_rays * 11 / 10);
}

// The same number of shadow rays, sent by the tree instead of by power alone.
TEST(ManyLights, CutsHaveLessThanAFifthOfTheRelativeVarianceOfDrawingByPower) {
  const auto scene = test::frame_of(hall_of_panels(400));
  TileScheduler scheduler;
  const auto picture = [&](const char* kernel, std::uint64_t seed) {
    return test::render(kernel, exact(4, 4), *scene, view(32), scheduler, seed);
  };
  const Render power = picture("ray", 1), cuts = picture("lightcuts", 1);
  const double ratio = noise(power, picture("ray", 2)) / noise(cuts, picture("lightcuts", 2));
  RecordProperty("variance_ratio", std::to_string(ratio));
  EXPECT_GT(ratio, 5.0);
  EXPECT_LT(std::abs(excess(power, cuts)), 4.0);
  EXPECT_LE(cuts.report.shadow_rays, 4U * 4U * 32U * 32U);
}

TEST(ManyLights, OneThreadAndManyGiveTheSameBits) {
  const auto scene = test::frame_of(hall_of_panels(100));
  const auto display = test::display(96, 90.0);
  const auto full = test::view_on(foveation::make_uniform_grid(display));
  TileScheduler one(1), many(4);
  const Render a = test::render("lightcuts", exact(1, 3), *scene, full, one);
  const Render b = test::render("lightcuts", exact(1, 3), *scene, full, many);
  EXPECT_TRUE(std::ranges::equal(a.planes().radiance.pixels(), b.planes().radiance.pixels()));
}

TEST(ManyLights, AutoTakesLightcuts) {
  const scene::SceneFacts facts = scene::facts_of(hall_of_panels(40));
  std::vector<std::string_view> registered;
  for (const auto& entry : kernels::kernel_table()) registered.push_back(entry.name);
  const auto chosen = scene::choose_kernel(facts, scene::IndirectLight::NotWanted, registered);
  EXPECT_EQ(chosen.kernel, "lightcuts");
  EXPECT_TRUE(scene::ScenePlan(facts, {.kernel = chosen.kernel}).has(scene::Step::LightTree));
}

}  // namespace
}  // namespace macula
