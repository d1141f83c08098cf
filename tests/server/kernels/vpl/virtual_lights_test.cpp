#include "server/kernels/vpl/virtual_lights.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <stop_token>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "shared/math/hash.h"
#include "tests/conformance/test_scenes.h"

namespace macula::kernels::vpl {
namespace {

constexpr double kPi = std::numbers::pi;

/// `count` matt materials of this reflectance.
scene::Scene matt(std::size_t count, float reflectance) {
  scene::Scene scene;
  scene.materials.resize(count);
  for (scene::Material& material : scene.materials) {
    material.base_color = Rgb{reflectance};
    material.specular = 0.0F;
  }
  return scene;
}

/// The box [-1, 1]^3 from inside; wall 2 k is at -1 of axis k, wall 2 k + 1 at +1, each of the
/// material of its number.
void add_box(scene::Scene& scene) {
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 a{0.0F}, b{0.0F}, corner{-1.0F};
    a[(axis + 1) % 3] = 2.0F, b[(axis + 2) % 3] = 2.0F;
    test::add_quad(scene, corner, a, b, static_cast<scene::Index>(2 * axis));
    corner[axis] = 1.0F;
    test::add_quad(scene, corner, b, a, static_cast<scene::Index>(2 * axis + 1));
  }
}

DVec3 total_flux(const VirtualLights& lights) {
  DVec3 sum{0.0};
  for (const auto& light : lights.lights) sum += DVec3(light.flux);
  return sum;
}

struct Estimate {
  double mean = 0.0, standard_error = 0.0;
};
Estimate estimate(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  double sum = 0.0, square = 0.0;
  for (const double value : values) sum += value;
  for (const double value : values) square += (value - sum / n) * (value - sum / n);
  return {sum / n, std::sqrt(square / (n * (n - 1.0)))};
}

/// Green, over sixteen seeds.
Estimate flux_of(const SceneFrame& scene, const Config& config = {}) {
  scheduling::TileScheduler scheduler(1);
  std::vector<double> fluxes;
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
    Config seeded = config;
    seeded.seed = seed;
    fluxes.push_back(total_flux(make_virtual_lights(scene, seeded, scheduler)).y);
  }
  return estimate(fluxes);
}

/// Within statistical error, and sure of it to 5 %; a millionth is single precision's.
void expect_mean(const Estimate& found, double expected) {
  const double error = 4.0 * found.standard_error + 1e-6 * expected;
  EXPECT_NEAR(found.mean, expected, error);
  EXPECT_GT(std::abs(found.mean - 1.05 * expected), error) << "a 5 % bias must be seen";
}

scene::Light lamp(scene::LightKind kind, const DVec3& position, const Vec3& direction) {
  scene::Light light;
  light.kind = kind;
  light.position = position;
  light.direction = glm::normalize(direction);
  light.intensity = {1.0F, 2.0F, 3.0F};
  light.inner_cone = Degrees{15.0};
  light.outer_cone = Degrees{35.0};
  return light;
}

TEST(VirtualLights, FluxesInAClosedBoxSumToTheLampsFluxTimesTheAlbedo) {
  scene::Scene scene = matt(6, 0.8F);
  add_box(scene);
  scene.lights = {lamp(scene::LightKind::Point, {0.3, -0.4, 0.5}, {0, -1, 0})};
  const auto frame = test::frame_of(std::move(scene));
  scheduling::TileScheduler scheduler(1);
  const VirtualLights lights = make_virtual_lights(*frame, {}, scheduler);
  EXPECT_EQ(lights.rays, 64U * 64U);
  EXPECT_EQ(lights.lights.size(), lights.rays) << "no ray leaves a closed box";
  EXPECT_NEAR(total_flux(lights).x, 4.0 * kPi * 0.8, 1e-4);
  expect_mean(flux_of(*frame), 4.0 * kPi * 2.0 * 0.8);
}

// Every wall gets its solid angle's share; a quarter of a wall, a x b at distance d from above its
// corner, has the solid angle atan(a b / (d sqrt(a^2 + b^2 + d^2))).
TEST(VirtualLights, EveryWallReflectsItsSolidAnglesShare) {
  scene::Scene scene = matt(6, 0.0F);
  for (int wall = 0; wall < 6; ++wall) {
    scene.materials[static_cast<std::size_t>(wall)].base_color =
        Rgb{0.15F * static_cast<float>(wall + 1)};
  }
  add_box(scene);
  const DVec3 at{0.3, -0.4, 0.5};
  scene.lights = {lamp(scene::LightKind::Point, at, {0, -1, 0})};
  double expected = 0.0;
  for (int wall = 0; wall < 6; ++wall) {
    const int axis = wall / 2;
    const double d = wall % 2 == 0 ? 1.0 + at[axis] : 1.0 - at[axis];
    double angle = 0.0;
    for (const double a : {1.0 + at[(axis + 1) % 3], 1.0 - at[(axis + 1) % 3]}) {
      for (const double b : {1.0 + at[(axis + 2) % 3], 1.0 - at[(axis + 2) % 3]}) {
        angle += std::atan(a * b / (d * std::sqrt(a * a + b * b + d * d)));
      }
    }
    expected += 2.0 * angle * 0.15 * (wall + 1);
  }
  expect_mean(flux_of(*test::frame_of(std::move(scene))), expected);
}

// Discs of the footprints' radii have the walls' area together, 6 x 2 x 2: each ray has its part of
// the sphere, and d^2 / cos of it is wall. Without the cosine a fifth of it would be missing.
TEST(VirtualLights, FootprintsOfALampTileTheWalls) {
  scene::Scene scene = matt(6, 0.8F);
  add_box(scene);
  scene.lights = {lamp(scene::LightKind::Point, {0.3, -0.4, 0.5}, {0, -1, 0})};
  scheduling::TileScheduler scheduler(1);
  double area = 0.0;
  const auto frame = test::frame_of(std::move(scene));
  for (const auto& light : make_virtual_lights(*frame, {}, scheduler).lights)
    area += kPi * static_cast<double>(light.footprint_m) * static_cast<double>(light.footprint_m);
  EXPECT_NEAR(area, 24.0, 0.5);
}

TEST(VirtualLights, TheSunsFluxIsWhatItsDirectionLetsTheFloorCatch) {
  scene::Scene scene = matt(2, 0.5F);
  scene.materials[1].base_color = Rgb{0.0F};
  test::add_quad(scene, {-1, 0, -1}, {0, 0, 3}, {2, 0, 0}, 0);
  test::add_quad(scene, {-3, 1, -1}, {0, 0, 1}, {1, 0, 0}, 1);  // black: widens the box, else shade
  const Vec3 direction(-1.0F, -2.0F, 0.0F);
  scene.lights = {lamp(scene::LightKind::Directional, DVec3{0.0}, direction)};
  const auto frame = test::frame_of(std::move(scene));
  expect_mean(flux_of(*frame), 2.0 * 6.0 * (2.0 / std::sqrt(5.0)) * 0.5);
}

// All of the cone, then the half of it that an edge under its axis leaves.
TEST(VirtualLights, ASpotsFluxIsItsConesFalloffIncluded) {
  const double outer = std::cos(35.0 * kPi / 180.0), inner = std::cos(15.0 * kPi / 180.0);
  const double flux = 2.0 * 2.0 * kPi * ((1.0 - inner) + (inner - outer) / 3.0);
  for (const double covered : {1.0, 0.5}) {
    scene::Scene scene = matt(1, 0.5F);
    const float left = covered == 1.0 ? -9.0F : 0.0F;
    test::add_quad(scene, {left, 0, -9}, {0, 0, 18}, {9 - left, 0, 0}, 0);
    scene.lights = {lamp(scene::LightKind::Spot, {0, 2, 0}, {0, -1, 0})};
    expect_mean(flux_of(*test::frame_of(std::move(scene))), covered * flux * 0.5);
  }
}

TEST(VirtualLights, PanelsAreAskedByTheirPowerAndSendPiTimesRadianceTimesArea) {
  scene::Scene scene = matt(8, 0.6F);
  add_box(scene);
  scene.materials[6].emission = {0.0F, 2.0F, 0.0F};
  scene.materials[7].emission = {5.0F, 0.5F, 1.0F};
  test::add_quad(scene, {-0.7F, 0.8F, 0.0F}, {0.5F, 0, 0}, {0, 0, 0.8F}, 6);
  test::add_quad(scene, {0.2F, -0.5F, -0.9F}, {0.3F, 0, 0}, {0, 0.3F, 0}, 7);
  const auto frame = test::frame_of(std::move(scene));
  ASSERT_EQ(frame->lights().emissive().size(), 4U);
  expect_mean(flux_of(*frame), kPi * (2.0 * 0.4 + 0.5 * 0.09) * 0.6);
  scheduling::TileScheduler scheduler(1);
  EXPECT_EQ(make_virtual_lights(*frame, {.emissive_side = 30}, scheduler).lights.size(), 900U);
}

// Radiance under a shading normal is albedo / pi times the irradiance at that normal, and leaves to
// the geometric side that the light came from, front or back.
TEST(VirtualLights, AShadingNormalActsOnTheLightThatArrives) {
  const double tilt = 0.6;
  for (const float side : {1.0F, -1.0F}) {
    scene::Scene scene = matt(1, 0.5F);
    test::add_quad(scene, {-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, 0);
    scene.meshes[0].normals.assign(4, Vec3(DVec3(std::sin(tilt), std::cos(tilt), 0.0)));
    scene.lights = {lamp(scene::LightKind::Directional, DVec3{0.0}, {0, -side, 0})};
    const auto frame = test::frame_of(std::move(scene));
    expect_mean(flux_of(*frame), 2.0 * 4.0 * std::cos(tilt) * 0.5);
    scheduling::TileScheduler scheduler(1);
    for (const auto& light : make_virtual_lights(*frame, {}, scheduler).lights) {
      ASSERT_EQ(light.normal, Vec3(0, side, 0));
    }
  }
}

// What leaves diffusely for light at 60 degrees, integrated over the ways it leaves by the midpoint
// rule: the BSDF with its diffuse part less the BSDF without.
TEST(VirtualLights, AGlossySurfaceSendsOutItsDiffusePartAlone) {
  scene::Scene scene = matt(1, 0.5F);
  scene.materials[0].specular = 1.0F;
  scene.materials[0].roughness = 0.5F;
  test::add_quad(scene, {-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, 0);
  const Vec3 up(0, 1, 0), to_light(DVec3(std::sqrt(0.75), 0.5, 0.0));
  scene.lights = {lamp(scene::LightKind::Directional, DVec3{0.0}, -to_light)};
  const auto frame = test::frame_of(std::move(scene));

  shading::Bsdf bsdf =
      frame->materials().bsdf(0, {0.5F, 0.5F}, 0.0F, shading::MaterialModel::AsInScene);
  ASSERT_TRUE(bsdf.glossy());
  shading::Bsdf lobe = bsdf;
  lobe.albedo = Rgb{0.0F};
  constexpr int kSteps = 100;
  double share = 0.0;
  for (int i = 0; i < kSteps * kSteps; ++i) {
    const double cosine = (i / kSteps + 0.5) / kSteps;
    const double sine = std::sqrt(1.0 - cosine * cosine);
    const double turn = 2.0 * kPi * (i % kSteps + 0.5) / kSteps;
    const Vec3 eye(DVec3(sine * std::cos(turn), cosine, sine * std::sin(turn)));
    const auto leaving = [&](const shading::Bsdf& of) {
      return static_cast<double>(
          shading::Reflector(of, shading::make_shading_frame(up, up, eye)).evaluate(to_light).x);
    };
    const double cos_light = 0.5;
    share += (leaving(bsdf) - leaving(lobe)) / cos_light * cosine * 2.0 * kPi / (kSteps * kSteps);
  }

  scheduling::TileScheduler scheduler(1);
  const double glossy = total_flux(make_virtual_lights(*frame, {}, scheduler)).y;
  const Config as_lambert{.model = shading::MaterialModel::Lambert};
  const double matt_flux = total_flux(make_virtual_lights(*frame, as_lambert, scheduler)).y;
  EXPECT_NEAR(glossy / matt_flux, share / 0.5, 0.01 * share / 0.5);
  EXPECT_LT(glossy, 0.97 * matt_flux) << "what the lobe takes must be seen";
}

/// A box with a smooth ball in it, lit by a lamp, a spot and a panel.
scene::Scene box_with_a_ball() {
  scene::Scene scene = matt(8, 0.7F);
  scene.materials[0].base_color = {0.8F, 0.2F, 0.2F};
  scene.materials[1].base_color = {0.2F, 0.3F, 0.8F};
  scene.materials[7].emission = {2.0F, 3.0F, 4.0F};
  add_box(scene);
  test::add_sphere(scene, {0.4F, -0.5F, 0.2F}, 0.3F, 12, 6);
  scene::Mesh& ball = scene.meshes.back();
  for (const Vec3& position : ball.positions) {
    ball.normals.push_back(glm::normalize(position - Vec3(0.4F, -0.5F, 0.2F)));
  }
  test::add_quad(scene, {-0.6F, 0.7F, -0.4F}, {0.4F, 0, 0}, {0, 0, 0.4F}, 7);
  scene.lights = {lamp(scene::LightKind::Point, {0.5, 0.3, -0.3}, {0, -1, 0}),
                  lamp(scene::LightKind::Spot, {-0.2, 0.5, 0.4}, {1.0F, -0.5F, 0.1F})};
  return scene;
}

bool sees(const SceneFrame& scene, const shading::Surface& from, const Vec3& normal,
          const lights::VirtualPointLight& light) {
  const Vec3 origin = visibility::offset_ray_origin(Vec3(from.position), normal, 0.0F, from.span_m);
  const auto distance = static_cast<float>(glm::distance(light.position, from.position));
  const Vec3 end = visibility::offset_ray_origin(Vec3(light.position), light.normal, 0.0F,
                                                 std::max(distance, light.span_m));
  return !scene.triangles().occluded(visibility::Ray{origin, end - origin, 0.0F, 1.0F});
}

/// Green radiance of a matt point by all virtual lights, unclamped, one shadow ray each.
double lit_by(const SceneFrame& scene, const VirtualLights& lights, const SurfacePoint& point) {
  const shading::Surface surface =
      scene.surfaces().at(point.instance, point.triangle, point.barycentric);
  const shading::Reflector reflector(
      scene.materials().bsdf(surface.material, surface.uv, 0.0F, shading::MaterialModel::AsInScene),
      shading::make_shading_frame(surface.geometric_normal, surface.shading_normal, point.to_eye));
  double sum = 0.0;
  for (const auto& light : lights.lights) {
    const auto arrival = lights::arriving(light, surface.position);
    if (!arrival) continue;
    const double value =
        static_cast<double>(reflector.evaluate(arrival->to_light).y * arrival->irradiance.y);
    if (value > 0.0 && sees(scene, surface, reflector.frame().geometric, light)) sum += value;
  }
  return sum;
}

/// Green: one bounce of brute force, direct light taken off; equal keys draw equal direct light.
Estimate bounced(const SceneFrame& scene, const SurfacePoint& point,
                 scheduling::TileScheduler& scheduler) {
  std::vector<SurfacePoint> points(256, point);
  for (std::size_t i = 0; i < points.size(); ++i) points[i].key = math::hash_mix(i + 1);
  KernelOptions options;
  options.samples_per_cell = 400;
  options.area_light_samples = 1;
  std::vector<Rgb> direct(points.size()), both(points.size());
  const auto shade = [&](int bounces, std::vector<Rgb>& out) {
    options.bounces = bounces;
    (*make_kernel("brute", options))->shade(points, scene, scheduler, out);
  };
  shade(0, direct);
  shade(1, both);
  std::vector<double> bounce;
  for (std::size_t i = 0; i < points.size(); ++i) {
    bounce.push_back(static_cast<double>(both[i].y) - static_cast<double>(direct[i].y));
  }
  return estimate(bounce);
}

/// A place on the first triangle of an instance.
using Place = std::pair<std::uint32_t, Vec2>;

void expect_brute_forces_bounce(const SceneFrame& scene, std::initializer_list<Place> places) {
  scheduling::TileScheduler scheduler(2);
  std::vector<VirtualLights> sets;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    sets.push_back(
        make_virtual_lights(scene, {.side = 48, .emissive_side = 48, .seed = seed}, scheduler));
  }
  for (const auto& [instance, barycentric] : places) {
    const shading::Surface surface = scene.surfaces().at(instance, 0, barycentric);
    SurfacePoint point;
    point.instance = instance;
    point.barycentric = barycentric;
    point.position = surface.position;
    point.geometric_normal = point.to_eye = surface.geometric_normal;
    std::vector<double> values;
    for (const VirtualLights& set : sets) values.push_back(lit_by(scene, set, point));
    const Estimate by_lights = estimate(values), by_brute = bounced(scene, point, scheduler);
    const double error = 4.0 * std::hypot(by_lights.standard_error, by_brute.standard_error);
    EXPECT_NEAR(by_lights.mean, by_brute.mean, error) << "instance " << instance;
    EXPECT_GT(std::abs(0.95 * by_lights.mean - by_brute.mean), error) << "5 % must be seen";
    EXPECT_GT(std::abs(1.05 * by_lights.mean - by_brute.mean), error) << "5 % must be seen";
  }
}

// Floor, left wall, back wall; the last place is half under the ball.
TEST(VirtualLights, LightAPointAsOneBounceOfBruteForceDoes) {
  expect_brute_forces_bounce(
      *test::frame_of(box_with_a_ball()),
      {{2, {0.3F, 0.35F}}, {0, {0.45F, 0.2F}}, {4, {0.35F, 0.3F}}, {2, {0.1F, 0.6F}}});
}

// A wall that the sun reaches lights the floor, and the floor the wall.
TEST(VirtualLights, OfTheSunLightAPointAsOneBounceOfBruteForceDoes) {
  scene::Scene scene = matt(2, 0.7F);
  test::add_quad(scene, {-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, 0);
  test::add_quad(scene, {-1, 0, -1}, {0, 2, 0}, {0, 0, 2}, 1);
  scene.lights = {lamp(scene::LightKind::Directional, DVec3{0.0}, {-2.0F, -1.0F, 0.5F})};
  expect_brute_forces_bounce(*test::frame_of(std::move(scene)),
                             {{0, {0.3F, 0.3F}}, {1, {0.3F, 0.4F}}});
}

TEST(VirtualLights, AreTheSameBitsForOneAndTwoThreads) {
  const auto frame = test::frame_of(box_with_a_ball());
  scheduling::TileScheduler one(1), two(2);
  const Config config{.side = 50, .emissive_side = 33, .seed = 5};
  const VirtualLights a = make_virtual_lights(*frame, config, one);
  const VirtualLights b = make_virtual_lights(*frame, config, two);
  const auto same = [](const auto& x, const auto& y) {
    return x.position == y.position && x.normal == y.normal && x.flux == y.flux;
  };
  EXPECT_EQ(a.rays, 2U * 2500U + 33U * 33U);
  EXPECT_TRUE(std::ranges::equal(a.lights, b.lights, same));
  const VirtualLights other = make_virtual_lights(*frame, {.side = 50, .seed = 6}, one);
  EXPECT_FALSE(same(a.lights.front(), other.lights.front())) << "the seed must matter";
}

TEST(VirtualLights, AreNoneWhereNothingIsLit) {
  scheduling::TileScheduler scheduler(1);
  const auto count = [&](scene::Scene scene, const Config& config = {}) {
    return make_virtual_lights(*test::frame_of(std::move(scene)), config, scheduler).lights.size();
  };
  using enum scene::LightKind;
  scene::Scene empty;
  EXPECT_EQ(count(empty), 0U);
  empty.lights = {lamp(Point, DVec3{0.0}, {0, -1, 0}), lamp(Spot, DVec3{0.0}, {0, -1, 0}),
                  lamp(Directional, DVec3{0.0}, {0, -1, 0})};
  EXPECT_EQ(count(empty), 0U);

  scene::Scene floor = matt(2, 0.5F);
  floor.materials[1].emission = Rgb{1.0F};
  test::add_quad(floor, {-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, 0);
  EXPECT_EQ(count(floor), 0U) << "a floor without a light";
  scene::Scene away = floor;
  away.lights = {lamp(Spot, {0, 1, 0}, {0, 1, 0})};
  test::add_quad(away, {-1, 0.5F, -1}, {0, 0, 2}, {2, 0, 0}, 1);  // shines up
  EXPECT_EQ(count(away), 0U) << "lights that shine past everything";
  scene::Scene lit = floor;
  lit.lights = {lamp(Spot, {0, 1, 0}, {0, -1, 0})};
  EXPECT_GT(count(lit), 0U);
  EXPECT_EQ(count(lit, {.side = 0}), 0U);
  lit.lights[0].intensity = Rgb{0.0F};
  EXPECT_EQ(count(lit), 0U) << "a black light";
}

TEST(VirtualLights, StopWhenAskedTo) {
  const auto frame = test::frame_of(box_with_a_ball());
  scheduling::TileScheduler scheduler(1);
  std::stop_source source;
  source.request_stop();
  scheduler.set_stop_token(source.get_token());
  const VirtualLights lights = make_virtual_lights(*frame, {}, scheduler);
  EXPECT_TRUE(lights.stopped);
  EXPECT_TRUE(lights.lights.empty());
}

}  // namespace
}  // namespace macula::kernels::vpl
