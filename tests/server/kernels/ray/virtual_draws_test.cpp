#include "server/kernels/ray/virtual_draws.h"

#include <gtest/gtest.h>

#include <cmath>

namespace macula::kernels::ray {
namespace {

std::vector<lights::VirtualPointLight> some_lights(int count) {
  std::vector<lights::VirtualPointLight> lights;
  for (int i = 0; i < count; ++i) {
    const auto at = [i](std::uint32_t d) { return sampling::sample(3, 5, i, d) - 0.5F; };
    lights.push_back({DVec3{4.0 * at(0), 2.5, 4.0 * at(1)},
                      glm::normalize(Vec3{at(2), -1.0F, at(3)}), 0.1F, Rgb{1.0F + at(4)}});
  }
  return lights;
}

/// A floor of points under the lights, each with random numbers of its own.
LitPoints floor_of_points(std::uint64_t seed) {
  LitPoints points{};
  for (std::size_t i = 0; i < sampling::kBatch; ++i) {
    shading::Surface surface;
    surface.position = {0.1, 0.0, -0.2};
    const shading::ShadingFrame frame{Vec3{0, 1, 0}, Vec3{0, 1, 0}, Vec3{0, 1, 0}};
    points.push(surface, shading::Reflector({.albedo = Rgb{0.5F}}, frame), {seed, 0, i});
  }
  return points;
}

struct Mean {
  double value = 0.0, error = 0.0;
};
/// Light that the points receive, were nothing in the way; `wrongly`: were all draws alike.
Mean mean_light(const VirtualLightShare& share, bool wrongly = false) {
  double sum = 0.0, square = 0.0, n = 0.0;
  lights::LightDraws drawn{};
  lights::AreaArrivalBatch arriving{};
  for (std::uint64_t seed = 0; seed < 16; ++seed) {
    const LitPoints points = floor_of_points(seed);
    const VirtualDraws draws(share, points);
    std::vector<double> light(points.count, 0.0);
    for (std::size_t round = 0; round < draws.rounds(); ++round) {
      draws.draw(round, drawn);
      if (wrongly)
        for (float& p : drawn.inverse_probability.at) p = p > 0.0F ? 8.0F : 0.0F;
      share.lights->arriving(drawn, points.position, points.count, arriving);
      for (std::size_t i = 0; i < points.count; ++i)
        light[i] += arriving.arrival.irradiance.x[i] * arriving.arrival.to_light.y[i];
    }
    for (const double value : light) sum += value, square += value * value, n += 1.0;
  }
  const double mean = sum / n;
  return {mean, std::sqrt(std::max(square / n - mean * mean, 0.0) / n)};
}

TEST(VirtualDraws, OfEveryKindHaveTheLightOfAllLightsAsMean) {
  const auto lights = some_lights(200);
  const lights::VirtualLightTable one(lights, 1, 0.2F), four(lights, 4, 0.2F);
  const double all = mean_light({&one}).value;
  ASSERT_GT(all, 0.0);
  const Mean classes = mean_light({&four});
  EXPECT_LT(std::abs(classes.value - all), 4.0 * classes.error + 1e-5 * all);
  const Mean some = mean_light({&one, 8});
  EXPECT_LT(std::abs(some.value - all), 4.0 * some.error + 1e-5 * all);
  EXPECT_LT(some.error, 0.2 * classes.error) << "they are drawn by what they bring";
  const Mean both = mean_light({&four, 8});
  EXPECT_LT(std::abs(both.value - all), 4.0 * both.error + 1e-5 * all);
  const Mean wrong = mean_light({&four, 8}, true);
  EXPECT_GT(std::abs(wrong.value - all), 4.0 * wrong.error + 0.05 * all);
}

TEST(VirtualDraws, ListPointsByClass) {
  const auto lights = some_lights(64);
  const lights::VirtualLightTable table(lights, 4, 0.0F);
  LitPoints points = floor_of_points(1);
  for (std::size_t i = 0; i < points.count; ++i)
    points.light_class.push_back(static_cast<std::uint16_t>(i % 4));
  const VirtualLightShare share{&table};
  const VirtualDraws draws(share, points);
  ASSERT_EQ(draws.by_class().size(), points.count);
  for (std::size_t i = 0; i < points.count; ++i) EXPECT_EQ(draws.by_class()[i] % 4, i / 64) << i;
}

}  // namespace
}  // namespace macula::kernels::ray
