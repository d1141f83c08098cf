#include "server/lights/light_list.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "shared/math/hash.h"

namespace macula::lights {
namespace {

constexpr double kPi = std::numbers::pi;

struct Lit {
  scene::Scene scene;
  LightList list() const { return {scene, shading::MaterialTable(scene)}; }
};

/// Triangles of radiance 1 a mesh each; counter-clockwise as seen from the lit side.
Lit triangles(const std::vector<Vec3>& corners, const std::vector<UVec3>& faces) {
  Lit lit;
  lit.scene.materials.resize(1);
  lit.scene.materials[0].emission = Rgb{1.0F};
  scene::Mesh mesh;
  mesh.positions = corners;
  mesh.triangles = faces;
  lit.scene.meshes = {mesh};
  lit.scene.instances = {{}};
  return lit;
}

struct Estimate {
  double mean, standard_error;
};

/// Irradiance of a patch at the origin that faces +Y. `pdf_factor` 1 is right, anything else wrong.
Estimate irradiance_at_origin(const LightList& list, int count, double pdf_factor = 1.0) {
  double sum = 0.0, square = 0.0;
  for (int i = 0; i < count; ++i) {
    const auto key = static_cast<std::uint64_t>(i);
    const AreaSample sample = list.sample_area({math::unit_float(math::hash_combine(key, 1)),
                                                math::unit_float(math::hash_combine(key, 2))});
    const double distance2 = glm::dot(sample.position, sample.position);
    const DVec3 to_light = sample.position / std::sqrt(distance2);
    const double at_light = -glm::dot(DVec3(list.emissive()[sample.light].normal), to_light);
    const double value = std::max(to_light.y, 0.0) * std::max(at_light, 0.0) /
                         (distance2 * sample.pdf_per_m2 * pdf_factor);
    sum += value, square += value * value;
  }
  const double mean = sum / count;
  return {mean, std::sqrt((square / count - mean * mean) / count)};
}

/// Lambert's formula: E = L / 2 sum of (angle an edge subtends) x (its normal's share along n).
double polygon_irradiance(const std::vector<DVec3>& corners, const DVec3& normal) {
  double sum = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const DVec3 a = glm::normalize(corners[i]),
                b = glm::normalize(corners[(i + 1) % corners.size()]);
    const DVec3 across = glm::cross(a, b);
    sum +=
        std::atan2(glm::length(across), glm::dot(a, b)) * glm::dot(glm::normalize(across), normal);
  }
  return std::abs(0.5 * sum);
}

TEST(LightList, ATriangleLightsAPatchByLambertsPolygonFormula) {
  const std::vector<Vec3> corners{{-0.4F, 1.0F, -0.3F}, {0.7F, 1.2F, -0.2F}, {0.1F, 0.9F, 0.8F}};
  const LightList list = triangles(corners, {{0, 1, 2}}).list();  // shines down
  const double exact = polygon_irradiance({corners.begin(), corners.end()}, {0.0, 1.0, 0.0});
  const Estimate estimate = irradiance_at_origin(list, 65536);
  EXPECT_NEAR(estimate.mean, exact, 4.0 * estimate.standard_error);
  const Estimate wrong = irradiance_at_origin(list, 65536, 1.02);
  EXPECT_GT(std::abs(wrong.mean - exact), 4.0 * wrong.standard_error);
}

// A disc of radius R at height h over the patch: E = pi L R^2 / (R^2 + h^2).
TEST(LightList, ADiscOnTheAxisLightsByItsClosedForm) {
  constexpr int kSides = 720;
  constexpr double kRadius = 0.8, kHeight = 1.1;
  std::vector<Vec3> corners{{0.0F, kHeight, 0.0F}};
  std::vector<UVec3> faces;
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2.0 * kPi * i / kSides;
    corners.emplace_back(kRadius * std::cos(angle), kHeight, kRadius * std::sin(angle));
    faces.emplace_back(0, i + 1, (i + 1) % kSides + 1);
  }
  const Estimate estimate = irradiance_at_origin(triangles(corners, faces).list(), 65536);
  const double exact = kPi * kRadius * kRadius / (kRadius * kRadius + kHeight * kHeight);
  EXPECT_NEAR(estimate.mean, exact, 4.0 * estimate.standard_error + 2e-5 * exact);
}

TEST(LightList, TheBackOfATriangleIsDark) {
  const LightList list =
      triangles({{-1.0F, 1.0F, -1.0F}, {0.0F, 1.0F, 1.0F}, {1.0F, 1.0F, -1.0F}}, {{0, 1, 2}})
          .list();
  ASSERT_GT(list.emissive()[0].normal.y, 0.0F);
  EXPECT_EQ(irradiance_at_origin(list, 100).mean, 0.0);
}

TEST(LightList, AMirroredInstanceShinesFromTheMirroredFront) {
  Lit lit = triangles({{0, 1, 0}, {1, 1, 0}, {0, 1, 1}}, {{0, 1, 2}});
  ASSERT_LT(lit.list().emissive()[0].normal.y, 0.0F);
  lit.scene.instances[0].parent_from_object[0][0] = -1.0;
  EXPECT_LT(lit.list().emissive()[0].normal.y, 0.0F);
}

TEST(LightList, TrianglesAreDrawnInProportionToTheirPower) {
  Lit lit =
      triangles({{0, 1, 0}, {1, 1, 0}, {0, 1, 1}, {3, 1, 0}, {0, 1, 3}}, {{0, 1, 2}, {0, 3, 4}});
  const LightList list = lit.list();
  ASSERT_EQ(list.emissive().size(), 2U);
  constexpr int kCount = 10000;
  int second = 0;
  for (int i = 0; i < kCount; ++i) {
    second += list.sample_area({(static_cast<float>(i) + 0.5F) / kCount, 0.5F}).light == 1;
  }
  EXPECT_NEAR(second, 0.9 * kCount, 2.0);  // areas 1 : 9
  double total = 0.0;
  for (std::uint32_t l = 0; l < 2; ++l) {
    total += static_cast<double>(list.pdf_per_m2(l)) * list.emissive()[l].area_m2;
  }
  EXPECT_NEAR(total, 1.0, 1e-6);
}

TEST(LightList, DegenerateTrianglesAreLeftOutAndCounted) {
  const LightList list =
      triangles({{0, 1, 0}, {1, 1, 0}, {2, 1, 0}, {0, 1, 1}}, {{0, 1, 2}, {0, 1, 3}}).list();
  EXPECT_EQ(list.emissive().size(), 1U);
  EXPECT_EQ(list.degenerate_count(), 1U);
}

TEST(LightList, ExtremesOfTheUnitSquareStayOnTheTriangles) {
  const LightList list =
      triangles({{0, 1, 0}, {1, 1, 0}, {0, 1, 1}, {3, 1, 0}, {0, 1, 3}}, {{0, 1, 2}, {0, 3, 4}})
          .list();
  for (const float u : {0.0F, 0x1.fffffep-1F}) {
    for (const float v : {0.0F, 0x1.fffffep-1F}) {
      const AreaSample sample = list.sample_area({u, v});
      EXPECT_GE(sample.barycentric.x, 0.0F);
      EXPECT_GE(sample.barycentric.y, 0.0F);
      EXPECT_LE(sample.barycentric.x + sample.barycentric.y, 1.0F + 1e-6F);
      EXPECT_GT(sample.pdf_per_m2, 0.0F);
    }
  }
}

TEST(PunctualLight, FallsWithTheSquareOfTheDistance) {
  scene::Light light;
  light.intensity = Rgb{8.0F};
  light.position = {0.0, 2.0, 0.0};
  const auto arrival = arriving(light, DVec3{0.0});
  ASSERT_TRUE(arrival);
  EXPECT_FLOAT_EQ(arrival->irradiance.x, 2.0F);
  EXPECT_FLOAT_EQ(arrival->distance_m, 2.0F);
  EXPECT_EQ(arrival->to_light, Vec3(0.0F, 1.0F, 0.0F));
}

TEST(PunctualLight, AtItsOwnPlaceNothingArrives) {
  EXPECT_FALSE(arriving(scene::Light{}, DVec3{0.0}));
}

// glTF: squared linear ramp in the cosine between the cones.
TEST(PunctualLight, ASpotRampsBetweenItsCones) {
  scene::Light light;
  light.kind = scene::LightKind::Spot;
  light.inner_cone = Radians{0.0}, light.outer_cone = Degrees{60.0};
  const auto at_angle = [&](double degrees) {
    const double a = Radians{Degrees{degrees}}.value();
    const auto arrival = arriving(light, DVec3{std::sin(a), -std::cos(a), 0.0});
    return arrival ? arrival->irradiance.x : 0.0F;
  };
  EXPECT_NEAR(at_angle(0.0), 1.0F, 1e-6F);
  const double ramp = (std::cos(kPi / 4.0) - 0.5) / 0.5;
  EXPECT_NEAR(at_angle(45.0), ramp * ramp, 1e-5);
  EXPECT_EQ(at_angle(61.0), 0.0F);
  EXPECT_EQ(at_angle(180.0), 0.0F);
}

TEST(PunctualLight, ADirectionalLightArrivesEverywhereAlike) {
  scene::Light light;
  light.kind = scene::LightKind::Directional;
  light.intensity = Rgb{3.0F};
  const auto arrival = arriving(light, DVec3{100.0, -5.0, 7.0});
  ASSERT_TRUE(arrival);
  EXPECT_TRUE(std::isinf(arrival->distance_m));
  EXPECT_EQ(arrival->irradiance, Rgb{3.0F});
  EXPECT_EQ(arrival->to_light, Vec3(0.0F, 1.0F, 0.0F));
}

}  // namespace
}  // namespace macula::lights
