#include "server/lights/virtual_light_table.h"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "shared/image/color.h"
#include "tests/server/lights/tree_oracle.h"

namespace macula::lights {
namespace {

std::vector<VirtualPointLight> some_lights(int count) {
  test::Random random(7);
  std::vector<VirtualPointLight> lights;
  for (int i = 0; i < count; ++i) {
    lights.push_back({DVec3(random.in_cube(3.0)), glm::normalize(random.in_cube(1.0)), 0.1F,
                      Rgb{1.0F, 2.0F, 3.0F} * static_cast<float>(i + 1)});
    if (i % 3 == 0) lights.back().footprint_m = 0.2F;  // of those, nearer ones count as they are
  }
  return lights;
}

constexpr float kLeast_m = 0.5F;

// The scalar function is the oracle; some of the points lie nearer than what counts, some behind.
TEST(VirtualLightTable, BringsWhatTheScalarFunctionSays) {
  const auto lights = some_lights(100);
  const VirtualLightTable table(lights, 4, kLeast_m);
  test::Random random(8);
  sampling::Vec3Batch points{};
  LightDraws draws{};
  for (std::size_t i = 0; i < 100; ++i) {
    points.set(i, random.in_cube(3.0));
    draws.light.at[i] = table.row_of(i);
    draws.inverse_probability.at[i] = i % 10 == 0 ? 0.0F : 4.0F;
  }
  AreaArrivalBatch out{};
  table.arriving(draws, points, 100, out);
  int dark = 0;
  for (std::size_t i = 0; i < 100; ++i) {
    const auto wanted = arriving(lights[i], DVec3(points[i]), static_cast<double>(kLeast_m));
    const Rgb got = out.arrival.irradiance[i];
    if (i % 10 == 0 || !wanted) {
      EXPECT_EQ(got, Rgb{0.0F});
      ++dark;
      continue;
    }
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(got[c], 4.0F * wanted->irradiance[c], 1e-4F * wanted->irradiance[c] + 1e-7F);
    EXPECT_GT(glm::dot(out.arrival.to_light[i], wanted->to_light), 0.99999F);
    EXPECT_NEAR(out.span.at[i], std::max(wanted->distance_m, 0.1F), 1e-5F);
  }
  EXPECT_GT(dark, 30);
  EXPECT_LT(dark, 80);
}

TEST(VirtualLightTable, CapsNearerThanTheLeastDistanceAndTheFootprintAlone) {
  VirtualPointLight light{DVec3{0.0, 1.0, 0.0}, Vec3{0, -1, 0}, 0.1F, Rgb{1.0F}};
  const auto at = [&](double distance_m) {
    return arriving(light, DVec3{0.0, 1.0 - distance_m, 0.0}, 0.5)->irradiance.x;
  };
  EXPECT_FLOAT_EQ(at(0.1), at(0.5)) << "not known: least distance";
  light.footprint_m = 0.2F;
  EXPECT_FLOAT_EQ(at(0.1), at(0.2));
  EXPECT_NEAR(at(0.3), at(0.6) * 4.0F, 1e-5F);
  light.footprint_m = 2.0F;
  EXPECT_FLOAT_EQ(at(0.1), at(0.5));
}

TEST(VirtualLightTable, PutsEveryLightIntoOneRowAndFillsClassesWithDarkness) {
  const auto lights = some_lights(101);
  const VirtualLightTable table(lights, 4, 0.0F);
  EXPECT_EQ(table.rounds(), 32U) << "26 lights in the largest class, whole vectors";
  std::set<std::uint32_t> rows;
  for (std::size_t i = 0; i < lights.size(); ++i) rows.insert(table.row_of(i));
  EXPECT_EQ(rows.size(), lights.size());
  EXPECT_TRUE(VirtualLightTable({}, 4, 0.0F).empty());
}

TEST(VirtualLightTable, WeighsByWhatArrivesOnASurface) {
  const auto lights = some_lights(60);
  const VirtualLightTable table(lights, 3, kLeast_m);
  const Vec3 point{0.3F, -0.2F, 0.4F}, normal = glm::normalize(Vec3{1.0F, 2.0F, -0.5F});
  std::vector<float> weights(table.rounds());
  for (int c = 0; c < 3; ++c) {
    table.weigh(c, point, normal, weights);
    for (std::size_t k = 0; k < weights.size(); ++k) {
      const std::size_t light = k * 3 + static_cast<std::size_t>(c);
      float wanted = 0.0F;
      if (light < lights.size()) {
        if (const auto arrival = arriving(lights[light], DVec3(point), double{kLeast_m}))
          wanted = image::luminance(arrival->irradiance) *
                   std::max(glm::dot(arrival->to_light, normal), 0.0F);
      }
      EXPECT_NEAR(weights[k], wanted, 1e-4F * wanted + 1e-7F) << c << ' ' << k;
    }
  }
}

}  // namespace
}  // namespace macula::lights
