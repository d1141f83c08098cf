#include "server/lights/light_rays.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "server/sampling/sobol.h"

namespace macula::lights {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::uint32_t kRays = 1U << 14;

scene::Light spot() {
  scene::Light light;
  light.kind = scene::LightKind::Spot;
  light.intensity = Rgb{3.0F};
  light.position = {1.0, 2.0, 3.0};
  light.direction = glm::normalize(Vec3(1.0F, -2.0F, 0.5F));
  light.inner_cone = Degrees{20.0};
  light.outer_cone = Degrees{55.0};
  return light;
}

/// What arrives, by the midpoint rule over cosines, within `angle` of the axis: W.
double arriving_within(const scene::Light& light, double angle) {
  const DVec3 axis(light.direction);
  const DVec3 side = glm::normalize(glm::cross(axis, DVec3(0.0, 0.0, 1.0)));
  constexpr int kSteps = 20'000;
  const double least = std::cos(angle), step = (1.0 - least) / kSteps;
  double sum = 0.0;
  for (int k = 0; k < kSteps; ++k) {
    const double c = 1.0 - (k + 0.5) * step;
    const auto there = arriving(light, light.position + c * axis + std::sqrt(1.0 - c * c) * side);
    if (there) sum += static_cast<double>(there->irradiance.x) * step;
  }
  return 2.0 * kPi * sum;
}

// Rays carry equal flux, so their number within an angle says how much light goes there. Sobol
// points miss a share by at most one of their number; the rest is the midpoint rule's.
TEST(LightRays, ASpotSendsThemWhereItsLightArrives) {
  const scene::Light light = spot();
  constexpr double kTolerance = 5e-4;
  double uniform_differs = 0.0;
  for (const double degrees : {10.0, 20.0, 30.0, 40.0, 50.0, 55.0, 90.0}) {
    const double angle = degrees * kPi / 180.0;
    double flux = 0.0;
    for (std::uint32_t i = 0; i < kRays; ++i) {
      const LightRay ray = ray_from(light, {}, sampling::sobol_owen_2d(i, 7));
      ASSERT_NEAR(glm::length(ray.direction), 1.0F, 1e-6F);
      const double cosine = glm::dot(DVec3(ray.direction), DVec3(light.direction));
      if (cosine >= std::cos(angle)) flux += static_cast<double>(ray.flux.x) / kRays;
    }
    const double whole = arriving_within(light, kPi / 2.0);
    EXPECT_NEAR(flux / whole, arriving_within(light, angle) / whole, kTolerance) << degrees;
    const double cone = 1.0 - std::cos(light.outer_cone.value());
    const double uniform = std::min(1.0, (1.0 - std::cos(angle)) / cone);
    uniform_differs = std::max(uniform_differs, std::abs(flux / whole - uniform));
  }
  EXPECT_GT(uniform_differs, 0.1) << "a spot without falloff must be seen";
}

TEST(LightRays, ASpotWithoutARampFillsItsConeEvenly) {
  scene::Light light = spot();
  light.inner_cone = light.outer_cone = Degrees{60.0};
  for (const float u : {0.0F, 0.25F, 0.999F}) {
    const LightRay ray = ray_from(light, {}, {u, 0.3F});
    EXPECT_NEAR(glm::dot(ray.direction, light.direction), 1.0F - 0.5F * u, 1e-5F);
    EXPECT_NEAR(ray.flux.x, 3.0 * 2.0 * kPi * 0.5, 1e-4);
  }
}

TEST(LightRays, APointSendsTheSameEverywhere) {
  scene::Light light;
  light.intensity = Rgb{2.0F};
  DVec3 mean{0.0};
  for (std::uint32_t i = 0; i < kRays; ++i) {
    const LightRay ray = ray_from(light, {}, sampling::sobol_owen_2d(i, 7));
    EXPECT_FLOAT_EQ(ray.flux.x, static_cast<float>(8.0 * kPi));
    mean += DVec3(ray.direction) / static_cast<double>(kRays);
  }
  EXPECT_LT(glm::length(mean), 1e-3);
}

// From outside a ball of radius r, distance d away, the light in the cone about it is
// 2 pi I (1 - sqrt(1 - (r/d)^2)); a terameter away that is pi I (r/d)^2, a directional light's.
TEST(LightRays, APointOutsideTheBoxSendsThemTowardsIt) {
  scene::Bounds box;
  box.include({4.0, 1.0, -2.0});
  box.include({7.0, 2.0, 3.0});
  const double radius = 0.5 * glm::length(box.size());
  for (const double distance : {1.001 * radius, 10.0, 1e5, 1e12}) {
    scene::Light light;
    light.position = box.centre() + distance * glm::normalize(DVec3{1.0, 2.0, -3.0});
    light.intensity = Rgb{static_cast<float>(distance * distance)};
    double reach = 0.0;
    for (std::uint32_t i = 0; i < kRays; ++i) {
      const LightRay ray = ray_from(light, box, sampling::sobol_owen_2d(i, 7));
      ASSERT_LE(glm::length(ray.origin - box.centre()), std::max(2.01 * radius, distance));
      const DVec3 from_centre = ray.origin - box.centre();
      reach = std::max(reach, glm::length(glm::cross(from_centre, DVec3(ray.direction))));
      const double share = 1.0 - std::sqrt(1.0 - std::pow(radius / distance, 2));
      const double flux =
          distance > 1e4 ? kPi * radius * radius : 2.0 * kPi * distance * distance * share;
      ASSERT_NEAR(ray.flux.x, flux, 1e-4 * flux) << distance;
    }
    EXPECT_NEAR(reach, radius, 0.02 * radius) << distance;
  }
  scene::Light inside;
  inside.position = box.centre();
  EXPECT_FLOAT_EQ(ray_from(inside, box, {0.3F, 0.6F}).flux.x, static_cast<float>(4.0 * kPi));
}

TEST(LightRays, ADirectionalLightCoversTheBoxFromBeforeIt) {
  scene::Light light;
  light.kind = scene::LightKind::Directional;
  light.direction = glm::normalize(Vec3(1.0F, -3.0F, 2.0F));
  scene::Bounds box;
  box.include({4.0, 1.0, -2.0});
  box.include({7.0, 2.0, 3.0});
  const DVec3 axis(light.direction);
  double reach = 0.0, flux = 0.0;
  for (std::uint32_t i = 0; i < kRays; ++i) {
    const LightRay ray = ray_from(light, box, sampling::sobol_owen_2d(i, 7));
    const DVec3 from_centre = ray.origin - box.centre();
    EXPECT_LE(glm::dot(from_centre, axis), -0.5 * glm::length(box.size())) << "starts in the box";
    reach = std::max(reach, glm::length(from_centre - glm::dot(from_centre, axis) * axis));
    flux = static_cast<double>(ray.flux.x);
  }
  double farthest = 0.0;
  for (const double x : {4.0, 7.0}) {
    for (const double y : {1.0, 2.0}) {
      for (const double z : {-2.0, 3.0}) {
        const DVec3 arm = DVec3(x, y, z) - box.centre();
        farthest = std::max(farthest, glm::length(glm::cross(arm, axis)));
      }
    }
  }
  EXPECT_NEAR(reach, farthest, 0.01 * farthest);
  EXPECT_NEAR(flux, kPi * farthest * farthest, 1e-4 * flux);
  EXPECT_EQ(ray_from(light, {}, {0.5F, 0.5F}).flux, Rgb{0.0F}) << "there is nothing to light";
}

}  // namespace
}  // namespace macula::lights
