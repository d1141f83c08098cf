// Light arriving at many points at once, against the functions for one point.
#include <gtest/gtest.h>

#include "server/lights/light_list.h"
#include "server/sampling/mappings.h"
#include "server/sampling/sample.h"

namespace macula::lights {
namespace {

using sampling::kBatch;
using sampling::SampleKey;

Vec3 anywhere(std::uint64_t i, float side) {
  const SampleKey key(11, 0, i);
  return side * (2.0F * Vec3{sampling::sample(key, 0), sampling::sample(key, 1),
                             sampling::sample(key, 2)} -
                 1.0F);
}

sampling::Vec3Batch points_within(float side) {
  sampling::Vec3Batch points{};
  for (std::size_t i = 0; i < kBatch; ++i) points.set(i, anywhere(i + 5000, side));
  return points;
}

/// `count` triangles of sizes from 1 : 1 to 1 : 100, and one far smaller than a guide's entry.
scene::Scene triangle_cloud(std::uint32_t count) {
  scene::Scene scene;
  scene.materials.resize(1);
  scene.materials[0].emission = {1.0F, 2.0F, 3.0F};
  scene::Mesh mesh;
  for (std::uint32_t i = 0; i < count; ++i) {
    const float size = i == 1 ? 1e-4F : 0.1F + 0.9F * sampling::sample(SampleKey(12, 0, i), 0);
    const Vec3 centre = anywhere(i, 2.0F);
    for (std::uint64_t corner = 0; corner < 3; ++corner) {
      mesh.positions.push_back(centre + anywhere(1000 + 3 * i + corner, size));
    }
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  scene.meshes = {mesh};
  scene.instances = {{}};
  return scene;
}

TEST(LightBatch, AreaSamplesAreThoseOfSinglePoints) {
  for (const std::uint32_t count : {1U, 2U, 3U, 100U}) {
    const scene::Scene scene = triangle_cloud(count);
    const shading::MaterialTable materials(scene);
    const shading::SurfaceTable surfaces(scene);
    const LightList list(scene, materials);
    const sampling::Vec3Batch points = points_within(3.0F);
    sampling::Vec2Batch u{};
    for (std::size_t i = 0; i < kBatch; ++i) {
      const Vec2 at = sampling::sample_2d(SampleKey(13, count, i), 0);
      u.x[i] = at.x, u.y[i] = at.y;
    }
    u.x[0] = 0.0F, u.x[1] = 0x1.fffffep-1F;
    AreaArrivalBatch batch{};
    list.arriving_area(u, points, kBatch, surfaces, materials, batch);
    int lit = 0;
    for (std::size_t i = 0; i < kBatch; ++i) {
      const AreaSample sample = list.sample_area(u[i]);
      ASSERT_EQ(batch.light.at[i], sample.light) << count << " lights, item " << i;
      EXPECT_LT(glm::distance(batch.position[i], Vec3(sample.position)), 1e-6F);
      const Vec3 towards(sample.position - DVec3(points[i]));
      const double distance2 = glm::dot(towards, towards);
      const Vec3& normal = list.emissive()[sample.light].normal;
      const double cosine = -glm::dot(normal, towards) / std::sqrt(distance2);
      const double wanted = std::max(cosine, 0.0) / (distance2 * sample.pdf_per_m2);
      EXPECT_NEAR(batch.arrival.irradiance[i].z, 3.0 * wanted, 1e-4 * wanted + 1e-5);
      EXPECT_LT(glm::distance(batch.arrival.to_light[i], glm::normalize(towards)), 1e-5F);
      lit += wanted > 0.0 ? 1 : 0;
    }
    EXPECT_GT(lit, 50);
    EXPECT_LT(lit, 240);
  }
}

TEST(LightBatch, ATexturedLightShinesWithItsTexel) {
  scene::Scene scene = triangle_cloud(2);
  scene.images.push_back({"half", image::Plane<image::Rgba8>(1, 1)});
  scene.images[0].pixels(0, 0) = {255, 0, 51, 255};
  scene.materials[0].emission_texture =
      scene::TextureRef{.image = 0, .space = scene::ColorSpace::Linear};
  const shading::MaterialTable materials(scene);
  const shading::SurfaceTable surfaces(scene);
  const LightList list(scene, materials);
  AreaArrivalBatch batch{};
  sampling::Vec2Batch u{};
  list.arriving_area(u, points_within(3.0F), kBatch, surfaces, materials, batch);
  int lit = 0;
  for (std::size_t i = 0; i < kBatch; ++i) {
    const Rgb irradiance = batch.arrival.irradiance[i];
    EXPECT_EQ(irradiance.y, 0.0F);
    EXPECT_NEAR(irradiance.z, 0.6F * irradiance.x, 1e-5F * irradiance.x);  // 3 x 51/255
    lit += irradiance.x > 0.0F ? 1 : 0;
  }
  EXPECT_GT(lit, 50);
}

TEST(LightBatch, PunctualLightsArriveAsAtSinglePoints) {
  scene::Light light;
  light.intensity = {4.0F, 5.0F, 6.0F};
  light.direction = glm::normalize(Vec3{0.2F, -1.0F, 0.1F});
  light.inner_cone = Degrees{15.0}, light.outer_cone = Degrees{50.0};
  light.position = {0.125, 2.0, -0.25};
  sampling::Vec3Batch points = points_within(3.0F);
  points.set(3, Vec3(light.position));  // where the inverse square has no value
  for (const auto kind :
       {scene::LightKind::Point, scene::LightKind::Spot, scene::LightKind::Directional}) {
    light.kind = kind;
    ArrivalBatch batch{};
    arriving(light, points, kBatch, batch);
    int lit = 0;
    for (std::size_t i = 0; i < kBatch; ++i) {
      const auto alone = arriving(light, DVec3(points[i]));
      const Rgb wanted = alone ? alone->irradiance : Rgb{0.0F};
      EXPECT_LT(glm::distance(batch.irradiance[i], wanted), 1e-5F + 1e-4F * glm::length(wanted));
      if (!alone || wanted == Rgb{0.0F}) continue;
      EXPECT_LT(glm::distance(batch.to_light[i], alone->to_light), 1e-5F);
      ++lit;
    }
    EXPECT_GT(lit, 20);
  }
}

}  // namespace
}  // namespace macula::lights
