#include "server/lights/placed_lights.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "server/lights/cut_sampler.h"
#include "tests/server/lights/tree_oracle.h"

namespace macula::lights {
namespace {

using sampling::kBatch;

scene::Light lamp(scene::LightKind kind, const DVec3& position) {
  scene::Light light;
  light.kind = kind;
  light.position = position;
  light.intensity = {4.0F, 5.0F, 6.0F};
  light.direction = glm::normalize(Vec3{0.2F, -1.0F, 0.1F});
  light.inner_cone = Degrees{15.0}, light.outer_cone = Degrees{50.0};
  return light;
}

/// Two lamps, a spot, a sun, a black lamp, and twenty triangles, every other one textured.
scene::Scene mixed() {
  using enum scene::LightKind;
  scene::Scene scene;
  scene.lights = {lamp(Point, {1.0, 2.0, 0.5}), lamp(Directional, {0.0, 0.0, 0.0}),
                  lamp(Spot, {-1.0, 2.5, 0.0}), lamp(Point, {0.0, 1.5, -2.0})};
  scene.lights.push_back(scene.lights[0]);
  scene.lights[4].intensity = Rgb{0.0F};
  scene.images.resize(1);
  scene.images[0].pixels = image::Plane<image::Rgba8>(2, 1);
  scene.images[0].pixels(0, 0) = {255, 0, 40, 255};
  scene.images[0].pixels(1, 0) = {10, 200, 40, 255};
  scene.materials.resize(2);
  for (scene::Material& material : scene.materials) material.emission = {2.0F, 3.0F, 1.0F};
  scene.materials[1].emission_texture = scene::TextureRef{};
  test::Random random(1);
  for (scene::Index i = 0; i < 20; ++i) {
    scene::Mesh mesh;
    const Vec3 corner = random.in_cube(2.0) + Vec3{0.0F, 2.0F, 0.0F};
    mesh.positions = {corner, corner + random.in_cube(0.5), corner + random.in_cube(0.5)};
    mesh.texcoords = {{0, 0}, {1, 0}, {0, 1}};
    mesh.triangles = {{0, 1, 2}};
    mesh.material = i % 2;
    scene.meshes.push_back(mesh);
    scene.instances.push_back({i, DMat4{1.0}});
  }
  return scene;
}

struct Lit {
  scene::Scene scene = mixed();
  shading::MaterialTable materials{scene};
  shading::SurfaceTable surfaces{scene, scene::pose_at(scene, {})};
  LightList list{scene, scene::pose_at(scene, {}), materials};
  PlacedLights placed{list};
};

TEST(PlacedLights, HoldEveryLightThatHasAPlaceAndShines) {
  const Lit lit;
  EXPECT_EQ(lit.placed.size(), 3U + lit.list.emissive().size());
  ASSERT_EQ(lit.placed.apart().size(), 1U);
  EXPECT_EQ(lit.placed.apart()[0].kind, scene::LightKind::Directional);
  EXPECT_EQ(lit.placed.tree().light_count(), lit.placed.size());
}

TEST(PlacedLights, WhatCannotBeOrderedStandsApart) {
  scene::Scene scene;
  for (const float intensity : {std::nanf(""), INFINITY, -1.0F, 0.0F, 1.0F}) {
    scene.lights.push_back(lamp(scene::LightKind::Point, {}));
    scene.lights.back().intensity = Rgb{intensity};
  }
  const PlacedLights placed(
      LightList(scene, scene::pose_at(scene, {}), shading::MaterialTable(scene)));
  EXPECT_EQ(placed.size(), 1U);
  EXPECT_EQ(placed.apart().size(), 3U);
}

/// A list made in place of another, larger or smaller, is the one made afresh.
TEST(PlacedLights, NothingStaysOfTheLightsThatWereThereBefore) {
  const Lit lit;
  scene::Scene few = mixed();
  few.lights.resize(3), few.instances.resize(5);
  const LightList list(few, scene::pose_at(few, {}), shading::MaterialTable(few));
  PlacedLights again = lit.placed;
  for (const LightList* of : {&list, &lit.list}) {
    again.make(*of);
    const PlacedLights fresh(*of);
    ASSERT_EQ(again.size(), fresh.size());
    EXPECT_EQ(again.apart().size(), fresh.apart().size());
    EXPECT_TRUE(std::ranges::equal(again.tree().light_of_leaf(), fresh.tree().light_of_leaf()));
    for (NodeId node = 1; node < 2 * fresh.tree().first_leaf(); ++node) {
      const NodeBounds a = again.tree().node(node), b = fresh.tree().node(node);
      EXPECT_EQ(a.empty, b.empty);
      EXPECT_EQ(a.bounds.intensity, b.bounds.intensity);
      EXPECT_EQ(a.bounds.centre, b.bounds.centre);
      EXPECT_EQ(a.bounds.half, b.bounds.half);
      EXPECT_EQ(a.bounds.axis, b.bounds.axis);
    }
  }
}

/// What light `index` of the list sends to `point`, by the rooms' scalar functions.
Rgb arriving_alone(const Lit& lit, std::uint32_t index, const Vec2& at, const Vec3& position,
                   const Vec3& point) {
  std::vector<scene::Light> lamps;
  for (const scene::Light& light : lit.list.punctual()) {
    const bool placed = light.kind != scene::LightKind::Directional;
    if (placed && light.intensity != Rgb{0.0F}) lamps.push_back(light);
  }
  if (index < lamps.size()) {
    const auto arrival = arriving(lamps[index], DVec3(point));
    return arrival ? arrival->irradiance : Rgb{0.0F};
  }
  const auto triangle = static_cast<std::uint32_t>(index - lamps.size());
  const EmissiveTriangle& light = lit.list.emissive()[triangle];
  const Vec3 towards = position - point;
  const float distance = glm::length(towards);
  const float cosine = std::max(-glm::dot(light.normal, towards / distance), 0.0F);
  return lit.list.emission(triangle, at, lit.surfaces, lit.materials) *
         (cosine * light.area_m2 / (distance * distance));
}

TEST(PlacedLights, LightArrivesAsFromEachLightAlone) {
  const Lit lit;
  test::Random random(2);
  sampling::Vec3Batch points{};
  sampling::Vec2Batch u{};
  LightDraws draws{};
  for (std::size_t i = 0; i < kBatch; ++i) {
    points.set(i, random.in_cube(2.5));
    u.x[i] = static_cast<float>(random.next()), u.y[i] = static_cast<float>(random.next());
    draws.light.at[i] = static_cast<std::uint32_t>(i % lit.placed.size());
    draws.inverse_probability.at[i] = i % 7 == 0 ? 0.0F : 2.5F;
  }
  AreaArrivalBatch out{};
  lit.placed.arriving(draws, u, points, kBatch, lit.list, lit.surfaces, lit.materials, out);
  int lamps = 0, triangles = 0;
  for (std::size_t i = 0; i < kBatch; ++i) {
    const std::uint32_t light = draws.light.at[i];
    const Rgb wanted = draws.inverse_probability.at[i] *
                       arriving_alone(lit, light, out.barycentric[i], out.position[i], points[i]);
    const Rgb got = out.arrival.irradiance[i];
    EXPECT_LT(glm::distance(got, wanted), 1e-5F + 1e-4F * glm::length(wanted)) << light;
    if (got == Rgb{0.0F}) continue;
    (light < 3 ? lamps : triangles) += 1;
    EXPECT_LT(glm::distance(out.arrival.to_light[i], glm::normalize(out.position[i] - points[i])),
              1e-5F);
    if (light < 3) {
      EXPECT_EQ(out.normal[i], Vec3{0.0F});
    }
  }
  EXPECT_GT(lamps, 15);
  EXPECT_GT(triangles, 50);
}

/// A lamp at the very receiver has no value there: nothing arrives, nothing is not a number.
TEST(PlacedLights, ALampAtTheReceiverSendsNothing) {
  const Lit lit;
  sampling::Vec3Batch points{};
  points.set(0, Vec3(lit.list.punctual()[0].position));
  LightDraws draws{};
  draws.inverse_probability.at[0] = 1.0F;
  AreaArrivalBatch out{};
  lit.placed.arriving(draws, {}, points, 1, lit.list, lit.surfaces, lit.materials, out);
  EXPECT_EQ(out.arrival.irradiance[0], Rgb{0.0F});
}

// ---- what the tree knows of a single light ----

PlacedLights placed_alone(const scene::Light& light) {
  scene::Scene scene;
  scene.lights = {light};
  return PlacedLights(LightList(scene, scene::pose_at(scene, {}), shading::MaterialTable(scene)));
}
/// Of the only light; the root is its leaf.
LightBounds bounds_of(const PlacedLights& placed) {
  return placed.tree().node(1).bounds;
}

TEST(PlacedLightBounds, ASpotNeverExceedsItsConeAndCosine) {
  for (const double inner : {0.0, 0.2, 0.7, 1.2}) {
    for (const double outer : {0.3, 0.8, 1.25, 1.57}) {
      if (outer <= inner) continue;
      scene::Light spot;
      spot.kind = scene::LightKind::Spot;
      spot.inner_cone = Radians{inner}, spot.outer_cone = Radians{outer};
      const LightBounds bounds = bounds_of(placed_alone(spot));
      for (double angle = 0.0; angle < 1.6; angle += 0.01) {
        Receiver receiver;
        receiver.position = Vec3(DVec3(std::sin(angle), -std::cos(angle), 0.0));
        receiver.normal = -receiver.position;
        const auto arrival = arriving(spot, DVec3(receiver.position));
        const double arrives = arrival ? image::luminance(arrival->irradiance) : 0.0;
        EXPECT_LE(arrives, test::reaching(bounds, receiver) + 1e-5) << inner << ' ' << angle;
      }
    }
  }
}

TEST(PlacedLightBounds, APointIsAPointAndShinesEverywhere) {
  const PlacedLights placed = placed_alone(lamp(scene::LightKind::Point, {1e5, 2.0, 3.0}));
  const LightBounds bounds = bounds_of(placed);
  EXPECT_EQ(placed.tree().oriented(), Oriented::No);
  EXPECT_EQ(bounds.centre, (Vec3{1e5F, 2.0F, 3.0F}));
  EXPECT_EQ(bounds.half, Vec3{0.0F});
  EXPECT_TRUE(bounds.shines_everywhere());
}

TEST(PlacedLightBounds, ATriangleIsAsBrightAsItsAreaTimesItsRadiance) {
  scene::Scene scene;
  scene.materials.resize(1);
  scene.materials[0].emission = Rgb{3.0F};
  scene::Mesh mesh;
  mesh.positions = {{0, 0, 0}, {2, 0, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 1, 2}};
  scene.meshes = {mesh};
  scene.instances = {{0, glm::translate(DMat4{1.0}, DVec3{1e5, 2.1, 3.3})}};
  const LightList list(scene, scene::pose_at(scene, {}), shading::MaterialTable(scene));
  const LightBounds bounds = bounds_of(PlacedLights(list));
  EXPECT_FLOAT_EQ(static_cast<float>(bounds.intensity), 3.0F);
  EXPECT_EQ(bounds.axis, (Vec3{0.0F, -1.0F, 0.0F}));
  EXPECT_EQ(test::cone_of(bounds), 0.0);
  for (const Vec3& corner : mesh.positions) {
    const DVec3 there = DVec3(Vec3(DVec3(1e5, 2.1, 3.3))) + DVec3(corner);  // as rows have it
    const DVec3 away = glm::abs(there - DVec3(bounds.centre)) - DVec3(bounds.half);
    EXPECT_LE(std::max({away.x, away.y, away.z}), 0.0);
  }
}

TEST(PlacedLightBounds, WhatHasNoPlaceOrNoLightHasNone) {
  EXPECT_EQ(placed_alone(scene::Light{}).size(), 1U);
  EXPECT_EQ(placed_alone(lamp(scene::LightKind::Directional, {})).size(), 0U);
  for (const float intensity : {0.0F, -1.0F, std::nanf(""), INFINITY}) {
    scene::Light light;
    light.intensity = Rgb{intensity};
    EXPECT_EQ(placed_alone(light).size(), 0U) << intensity;
  }
  scene::Light nowhere;
  nowhere.position.x = std::nan("");
  EXPECT_EQ(placed_alone(nowhere).size(), 0U);
}

// ---- virtual lights among them ----

VirtualPointLight virtual_light(test::Random& random) {
  VirtualPointLight light;
  light.position = DVec3(random.in_cube(2.0));
  light.normal = random.direction();
  light.span_m = 0.5F + static_cast<float>(random.next());
  light.flux = {1.0F, 2.0F, static_cast<float>(random.next())};
  return light;
}

TEST(PlacedVirtualLights, StandBehindTheOthersAndShineAsEachAlone) {
  const Lit lit;
  test::Random random(7);
  std::vector<VirtualPointLight> lights;
  for (int i = 0; i < 40; ++i) lights.push_back(virtual_light(random));
  lights[3].flux = Rgb{0.0F};
  PlacedLights placed = lit.placed;
  placed.make(lit.list, lights);
  ASSERT_EQ(placed.size(), lit.placed.size() + 39);
  std::erase_if(lights, [](const VirtualPointLight& light) { return light.flux == Rgb{0.0F}; });
  sampling::Vec3Batch points{};
  LightDraws draws{};
  for (std::size_t i = 0; i < kBatch; ++i) {
    points.set(i, random.in_cube(2.5));
    draws.light.at[i] = static_cast<std::uint32_t>(lit.placed.size() + i % 39);
    draws.inverse_probability.at[i] = 3.0F;
  }
  AreaArrivalBatch out{};
  placed.arriving(draws, {}, points, kBatch, lit.list, lit.surfaces, lit.materials, out);
  int lit_points = 0;
  for (std::size_t i = 0; i < kBatch; ++i) {
    const VirtualPointLight& light = lights[i % 39];
    const auto arrival = arriving(light, DVec3(points[i]));
    const Rgb wanted = arrival ? 3.0F * arrival->irradiance : Rgb{0.0F};
    EXPECT_LT(glm::distance(out.arrival.irradiance[i], wanted),
              1e-4F * glm::length(wanted) + 1e-6F);
    EXPECT_EQ(out.normal[i], light.normal);
    EXPECT_EQ(out.position[i], Vec3(light.position));
    EXPECT_GE(out.span.at[i], light.span_m);
    lit_points += arrival.has_value();
  }
  EXPECT_GT(lit_points, 80);
}

TEST(PlacedVirtualLights, EachLeafHoldsItsLightAndNoMore) {
  const Lit lit;
  test::Random random(8);
  const std::vector<VirtualPointLight> lights{virtual_light(random)};
  PlacedLights placed;
  placed.make(LightList(scene::Scene{}, lit.materials), lights);
  const LightBounds bounds = bounds_of(placed);
  EXPECT_EQ(bounds.centre, Vec3(lights[0].position));
  EXPECT_EQ(bounds.half, Vec3{0.0F});
  EXPECT_EQ(bounds.axis, lights[0].normal);
  EXPECT_EQ(test::cone_of(bounds), 0.0);
  const double flux = image::luminance(lights[0].flux);
  EXPECT_NEAR(bounds.intensity, flux / std::numbers::pi, 1e-6 * flux);
}

// ---- what a batch of receivers draws ----

struct Receivers {
  sampling::Vec3Batch points{}, normals{};
  std::vector<sampling::SampleKey> keys;

  explicit Receivers(std::uint64_t seed) {
    test::Random random(seed);
    for (std::size_t i = 0; i < kBatch; ++i) {
      points.set(i, random.in_cube(1.5)), normals.set(i, random.direction());
      keys.emplace_back(seed, 0, i);
    }
  }
};

TEST(CutSampler, AReceiverDrawsTheSameWhereverItStandsInABatch) {
  const LightTree tree(test::random_lights(500, test::Kind::Mixed, 3));
  Receivers all(4);
  CutSampler sampler(tree, 6);
  sampler.cut(all.points, all.normals, kBatch);
  EXPECT_EQ(sampler.rounds(), 6U);
  for (const std::size_t i : {0UL, 17UL, 255UL}) {
    Receivers one(4);
    one.points.set(0, all.points[i]), one.normals.set(0, all.normals[i]);
    CutSampler alone(tree, 6);
    alone.cut(one.points, one.normals, 1);
    for (std::size_t round = 0; round < alone.rounds(); ++round) {
      LightDraws together{}, apart{};
      sampler.draw(round, all.keys, 3, together);
      alone.draw(round, {&all.keys[i], 1}, 3, apart);
      EXPECT_EQ(together.light.at[i], apart.light.at[0]);
      EXPECT_EQ(together.inverse_probability.at[i], apart.inverse_probability.at[0]);
    }
  }
}

// T-SLC-1 through the batch, over keys and over the samples of one key.
TEST(CutSampler, TheMeanOverDrawsIsTheSumOverLights) {
  const auto lights = test::random_lights(300, test::Kind::Points, 5);
  const LightTree tree(lights);
  const Receivers receivers(6);
  CutSampler sampler(tree, 4);
  constexpr std::size_t kPoints = 32;
  sampler.cut(receivers.points, receivers.normals, kPoints);
  std::vector<double> sum(kPoints), square(kPoints);
  constexpr std::uint32_t kSamples = 4096;
  const auto sends = [&](std::uint32_t light, std::size_t i) {
    const Receiver receiver{receivers.points[i], receivers.normals[i]};
    const Vec3 away = lights[light].centre - receiver.position;
    return test::reaching(lights[light], receiver) / static_cast<double>(glm::dot(away, away));
  };
  LightDraws draws{};
  for (std::uint32_t s = 0; s < kSamples; ++s) {
    std::vector<double> value(kPoints);
    for (std::size_t round = 0; round < sampler.rounds(); ++round) {
      sampler.draw(round, receivers.keys, s, draws);
      for (std::size_t i = 0; i < kPoints; ++i) {
        if (draws.inverse_probability.at[i] == 0.0F) continue;
        value[i] +=
            sends(draws.light.at[i], i) * static_cast<double>(draws.inverse_probability.at[i]);
      }
    }
    for (std::size_t i = 0; i < kPoints; ++i) sum[i] += value[i], square[i] += value[i] * value[i];
  }
  int missed = 0, stratified = 0;
  for (std::size_t i = 0; i < kPoints; ++i) {
    double exact = 0.0;
    for (std::uint32_t l = 0; l < lights.size(); ++l) exact += sends(l, i);
    const double mean = sum[i] / kSamples;
    const double error =
        std::sqrt(std::max(square[i] / kSamples - mean * mean, 0.0) / double{kSamples});
    missed += std::abs(mean - exact) > 4.0 * error + 1e-5 * exact;
    stratified += std::abs(mean - exact) < 0.5 * error + 1e-5 * exact;
  }
  EXPECT_LE(missed, 1);
  EXPECT_GT(stratified, 25) << "independent draws would come so near 12 times";
}

}  // namespace
}  // namespace macula::lights
