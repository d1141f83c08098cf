// Pictures whose radiance is known in closed form: furnaces, polygon and disc lights; and two
// kernels under one environment.
#include <cmath>
#include <cstring>
#include <numbers>
#include <vector>

#include "shared/math/hash.h"
#include "tests/conformance/polygon_light.h"
#include "tests/conformance/test_scenes.h"

namespace macula {
namespace {

constexpr double kPi = std::numbers::pi;
const char* const kKernels[] = {"ray", "brute"};

kernels::KernelOptions exact(int samples, int light_samples) {
  kernels::KernelOptions options;
  options.mode = kernels::Mode::Exact;
  options.bounces = 0;
  options.samples_per_cell = samples;
  options.area_light_samples = options.environment_samples = light_samples;
  return options;
}

struct Estimate {
  double mean = 0.0, standard_error = 0.0;
};
/// Luminance over the cells whose surface id is not 0; cells are independent.
Estimate over_surfaces(const test::Render& render) {
  Estimate estimate;
  double variance = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < render.planes().radiance.size(); ++i) {
    if (render.planes().surface_id.pixels()[i] == 0) continue;
    estimate.mean += image::luminance(render.planes().radiance.pixels()[i]);
    variance += render.planes().variance.pixels()[i];
    ++count;
  }
  estimate.mean /= count;
  estimate.standard_error = std::sqrt(variance) / count;
  return estimate;
}

/// A white ball that fills the view, in an environment of radiance 1.
scene::Scene white_furnace() {
  scene::Scene scene = test::furnace(1.0F);
  scene.settings.ambient = Rgb{0.0F};
  scene.environment = scene::Environment{};
  scene.environment->radiance(0, 0) = Rgb{1.0F};
  return scene;
}
kernels::View inside_the_ball() {
  return test::view_on(foveation::make_uniform_grid(test::display(12, 20.0)));
}

TEST(Furnace, AWhiteLambertianBallVanishesInItsEnvironment) {
  const auto scene = test::frame_of(white_furnace());
  kernels::TileScheduler scheduler;
  const auto view = test::view_on(foveation::make_uniform_grid(test::display(20)));
  for (const char* kernel : kKernels) {
    const auto render = test::render(kernel, exact(1, 1), *scene, view, scheduler);
    for (const Rgb& value : render.planes().radiance.pixels()) {
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(value[c], 1.0F, 1e-4F) << kernel;
    }
  }
}

TEST(Furnace, WhiteUnderAClearCoatReflectsAllAndCountsNothingTwice) {
  for (const float roughness : {0.2F, 0.6F, 1.0F}) {
    scene::Scene coated = white_furnace();
    coated.materials[0].specular = 1.0F;
    coated.materials[0].roughness = roughness;
    const auto scene = test::frame_of(std::move(coated));
    kernels::TileScheduler scheduler;
    for (const char* kernel : kKernels) {
      const auto estimate =
          over_surfaces(test::render(kernel, exact(64, 4), *scene, inside_the_ball(), scheduler));
      // The lobe's albedo comes from a table good to 3e-3.
      EXPECT_NEAR(estimate.mean, 1.0, 4.0 * estimate.standard_error + 3e-3)
          << kernel << " at roughness " << roughness;
    }
  }
}

TEST(Furnace, AWhiteMetalReflectsItsLobesAlbedoAndNeverMore) {
  scene::Scene metal = white_furnace();
  metal.materials[0].metallic = 1.0F;
  metal.materials[0].roughness = 0.4F;
  const auto scene = test::frame_of(std::move(metal));
  kernels::TileScheduler scheduler;
  const auto ray =
      over_surfaces(test::render("ray", exact(64, 4), *scene, inside_the_ball(), scheduler));
  const auto brute =
      over_surfaces(test::render("brute", exact(64, 4), *scene, inside_the_ball(), scheduler));
  EXPECT_NEAR(ray.mean, brute.mean,
              4.0 * std::hypot(ray.standard_error, brute.standard_error) + 1e-3);
  EXPECT_LT(ray.mean, 1.0);
  EXPECT_GT(ray.mean, 0.8) << "one scattering loses little at this roughness";
}

TEST(Furnace, TheAmbientTermOfAnOpenPointIsThatOfAnEnvironment) {
  kernels::TileScheduler scheduler;
  const auto lit = test::frame_of(white_furnace());
  const auto ambient = test::frame_of(test::furnace(1.0F));
  const auto a = test::render("ray", exact(1, 1), *lit, inside_the_ball(), scheduler);
  const auto b = test::render("ray", exact(1, 1), *ambient, inside_the_ball(), scheduler);
  EXPECT_NEAR(over_surfaces(a).mean, over_surfaces(b).mean, 1e-5);
}

/// small_room under a sky with a small sun and without its ambient term.
scene::Scene room_under_a_sky() {
  scene::Scene scene = test::small_room();
  scene.settings.ambient = Rgb{0.0F};
  scene.environment = scene::Environment{};
  scene.environment->radiance = image::Plane<Rgb>(32, 16, Rgb{0.3F, 0.4F, 0.6F});
  scene.environment->radiance(12, 5) = scene.environment->radiance(13, 5) = Rgb{14.0F, 12.0F, 9.0F};
  scene.environment->yaw = Degrees{160.0};
  return scene;
}

/// Largest difference of the means of 8x8 blocks, in standard errors of the difference.
double worst_block(const test::Render& a, const test::Render& b, double gain = 1.0) {
  double worst = 0.0;
  for (int by = 0; by < 24; by += 8) {
    for (int bx = 0; bx < 24; bx += 8) {
      double difference = 0.0, variance = 0.0;
      for (int i = 0; i < 64; ++i) {
        const int x = bx + i % 8, y = by + i / 8;
        difference += gain * image::luminance(a.planes().radiance(x, y)) -
                      image::luminance(b.planes().radiance(x, y));
        variance += a.planes().variance(x, y) + b.planes().variance(x, y);
      }
      worst = std::max(worst, std::abs(difference) / std::sqrt(variance));
    }
  }
  return worst;
}

TEST(Environment, TableAndMixtureAgreeWithTheSurfacesOwnDirections) {
  const auto scene = test::frame_of(room_under_a_sky());
  const auto view = test::view_on(foveation::make_uniform_grid(test::display(24)));
  kernels::TileScheduler scheduler;
  const auto ray = test::render("ray", exact(256, 4), *scene, view, scheduler, 7);
  const auto brute = test::render("brute", exact(256, 8), *scene, view, scheduler, 8);
  EXPECT_LT(worst_block(ray, brute), 4.5);
  EXPECT_GT(worst_block(ray, brute, 1.05), 4.5) << "a 5 % bias must be seen";
}

TEST(Environment, OneThreadAndManyGiveTheSameBitsInEveryKernel) {
  const auto scene = test::frame_of(room_under_a_sky());
  const auto view = test::view_on(foveation::make_uniform_grid(test::display(40)));
  kernels::TileScheduler one(1), many(4);
  for (const kernels::KernelEntry& kernel : kernels::kernel_table()) {
    if (!kernels::renders(kernel, kernels::SceneKind::Triangles)) continue;
    const std::string name(kernel.name);
    const auto a = test::render(name, exact(2, 2), *scene, view, one);
    const auto b = test::render(name, exact(2, 2), *scene, view, many);
    EXPECT_EQ(0, std::memcmp(a.planes().radiance.data(), b.planes().radiance.data(),
                             a.planes().radiance.size() * sizeof(Rgb)))
        << name;
  }
}

// ---- area lights ----

/// A white Lambertian floor under one light of radiance 1, which is the scene's second mesh.
scene::Scene floor_under(const std::vector<Vec3>& corners, const std::vector<UVec3>& triangles) {
  scene::Scene scene;
  scene.materials.resize(2);
  scene.materials[0].specular = scene.materials[1].specular = 0.0F;
  scene.materials[1].base_color = Rgb{0.0F};
  scene.materials[1].emission = Rgb{1.0F};
  test::add_quad(scene, {-2, 0, 4}, {8, 0, 0}, {0, 0, -8}, 0);
  scene::Mesh light;
  light.positions = corners;
  light.triangles = triangles;
  light.material = 1;
  scene.instances.push_back({1, DMat4{1.0}});
  scene.meshes.push_back(light);
  return scene;
}

/// Radiance leaving the floor's middle, (2, 0, 0), over independent samples.
Estimate at_the_middle(const kernels::SceneFrame& scene, const std::string& kernel) {
  constexpr std::size_t kPoints = 4096;
  std::vector<kernels::SurfacePoint> points(kPoints);
  for (std::size_t i = 0; i < kPoints; ++i) {
    points[i].position = {2, 0, 0};
    points[i].to_eye = points[i].geometric_normal = {0, 1, 0};
    points[i].barycentric = {0.0F, 0.5F};  // between corners 0 and 2 of the quad
    points[i].key = math::hash_mix(i);
  }
  std::vector<Rgb> radiance(kPoints);
  kernels::TileScheduler scheduler;
  (*kernels::make_kernel(kernel, exact(1, 1)))->shade(points, scene, scheduler, radiance);
  double sum = 0.0, square = 0.0;
  for (const Rgb& value : radiance) {
    sum += value.x;
    square += static_cast<double>(value.x) * value.x;
  }
  const double mean = sum / kPoints;
  return {mean, std::sqrt((square / kPoints - mean * mean) / kPoints)};
}

TEST(AreaLight, ATriangleGivesWhatLambertsPolygonFormulaSays) {
  const std::vector<Vec3> corners = {{1.5F, 1.2F, 0.4F}, {2.9F, 1.6F, -0.6F}, {2.7F, 1.1F, 0.8F}};
  // Both windings: one of them shines up.
  const auto lit = test::frame_of(floor_under(corners, {{0, 1, 2}}));
  const auto turned = test::frame_of(floor_under(corners, {{0, 2, 1}}));
  const double expected =
      test::polygon_irradiance({2, 0, 0}, {0, 1, 0},
                               {DVec3(corners[0]), DVec3(corners[1]), DVec3(corners[2])}) /
      kPi;
  for (const char* kernel : kKernels) {
    const Estimate a = at_the_middle(*lit, kernel), b = at_the_middle(*turned, kernel);
    const Estimate shining = a.mean > b.mean ? a : b, dark = a.mean > b.mean ? b : a;
    EXPECT_NEAR(shining.mean, expected, 4.0 * shining.standard_error + 1e-5 * expected) << kernel;
    EXPECT_GT(std::abs(1.05 * shining.mean - expected), 4.0 * shining.standard_error) << kernel;
    EXPECT_EQ(dark.mean, 0.0) << "light leaves the front alone";
  }
}

TEST(AreaLight, ADiscOnTheAxisGivesPiLTimesItsShareOfTheView) {
  constexpr double kRadius = 0.8, kHeight = 1.3;
  constexpr std::uint32_t kSides = 256;
  std::vector<Vec3> corners = {{2, static_cast<float>(kHeight), 0}};
  std::vector<UVec3> triangles;
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const double phi = 2.0 * kPi * i / kSides;
    corners.emplace_back(2.0 + kRadius * std::cos(phi), kHeight, kRadius * std::sin(phi));
    triangles.emplace_back(0, 1 + i, 1 + (i + 1) % kSides);
  }
  const auto scene = test::frame_of(floor_under(corners, triangles));
  // E = pi L R^2 / (R^2 + h^2); a polygon of 256 sides misses 1e-4 of the disc.
  const double expected = kRadius * kRadius / (kRadius * kRadius + kHeight * kHeight);
  for (const char* kernel : kKernels) {
    const Estimate estimate = at_the_middle(*scene, kernel);
    EXPECT_NEAR(estimate.mean, expected, 4.0 * estimate.standard_error + 2e-4 * expected) << kernel;
  }
}

/// The floor of floor_under() made of two triangles 20 km wide, turned, with the lit point at
/// `centre`, under a lamp 1.3 m above it.
TEST(AreaLight, AWideFloorNeitherShadowsItselfNorLeaksAtTheOriginAndFarFromIt) {
  const DMat3 turn(glm::mat3_cast(glm::normalize(DQuat(0.8, 0.3, -0.4, 0.2))));
  for (const DVec3& centre : {DVec3{0.0}, DVec3{6000.0, -7000.0, 5000.0}}) {
    const auto placed = [&](const DVec3& local) { return Vec3(centre + turn * local); };
    const auto add = [&](scene::Scene& scene, const std::vector<DVec3>& corners,
                         scene::Index material) {
      scene::Mesh mesh;
      for (const DVec3& corner : corners) mesh.positions.push_back(placed(corner));
      mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
      mesh.material = material;
      scene.instances.push_back({static_cast<scene::Index>(scene.meshes.size()), DMat4{1.0}});
      scene.meshes.push_back(mesh);
    };
    scene::Scene source;
    source.materials.resize(2);
    source.materials[0].specular = source.materials[1].specular = 0.0F;
    source.materials[1].emission = Rgb{1.0F};
    source.materials[1].base_color = Rgb{0.0F};
    constexpr double kWide = 10'000.0;
    add(source, {{-kWide, 0, kWide}, {kWide, 0, kWide}, {kWide, 0, -kWide}, {-kWide, 0, -kWide}},
        0);
    add(source, {{-0.6, 1.3, 0.5}, {-0.6, 1.3, -0.5}, {0.6, 1.3, -0.5}, {0.6, 1.3, 0.5}}, 1);
    std::vector<DVec3> lamp;
    for (const Vec3& corner : source.meshes[1].positions) lamp.emplace_back(corner);
    const auto scene = test::frame_of(source);
    // Points within 2 m of the middle, where a ray from above meets the floor.
    std::vector<kernels::SurfacePoint> points;
    std::vector<double> expected;
    for (int i = 0; i < 2048; ++i) {
      const DVec3 up = turn * DVec3{0.0, 1.0, 0.0};
      const double x = -2.0 + 4.0 * (i % 64) / 63.0, z = -2.0 + 4.0 * (i / 64) / 31.0;
      const auto hit =
          scene->triangles().intersect(visibility::Ray{placed({x, 1.0, z}), Vec3(-up)});
      ASSERT_TRUE(hit && hit->instance == 0);
      kernels::SurfacePoint& point = points.emplace_back();
      point.instance = hit->instance, point.triangle = hit->triangle;
      point.barycentric = {hit->u, hit->v};
      point.position =
          scene->surfaces().at(point.instance, point.triangle, point.barycentric).position;
      point.to_eye = point.geometric_normal = Vec3(up);
      point.key = math::hash_mix(static_cast<std::uint64_t>(i));
      expected.push_back(test::polygon_irradiance(point.position, up, lamp) / kPi);
    }
    for (const char* kernel : {"ray", "lightcuts", "brute"}) {
      std::vector<Rgb> radiance(points.size());
      kernels::TileScheduler scheduler;
      (*kernels::make_kernel(kernel, exact(1, 16)))->shade(points, *scene, scheduler, radiance);
      double difference = 0.0, square = 0.0, level = 0.0;
      for (std::size_t i = 0; i < points.size(); ++i) {
        const double d = radiance[i].x - std::abs(expected[i]);
        difference += d, square += d * d, level += std::abs(expected[i]);
      }
      // The lamp is where its float vertices have it; a thousandth for rounding far away.
      EXPECT_NEAR(difference, 0.0, 4.0 * std::sqrt(square) + 1e-3 * level)
          << kernel << " at " << centre.x;
      EXPECT_LT(4.0 * std::sqrt(square), 0.025 * level) << "a fortieth in shadow would be seen";
    }
  }
}

TEST(AreaLight, ABlendedLampGivesItsCoveragesShareOfLight) {
  const std::vector<Vec3> corners = {{1.5F, 1.2F, 0.4F}, {2.7F, 1.1F, 0.8F}, {2.9F, 1.6F, -0.6F}};
  scene::Scene source = floor_under(corners, {{0, 2, 1}, {0, 1, 2}});
  const auto opaque = test::frame_of(source);
  source.materials[1].alpha_mode = scene::AlphaMode::Blend;
  source.materials[1].alpha = 0.3F;
  const auto blended = test::frame_of(source);
  source.images.push_back({"dense to thin", image::Plane<image::Rgba8>(1, 1, {255, 255, 255, 51})});
  source.materials[1].base_color_texture = scene::TextureRef{};
  source.meshes[1].texcoords.assign(corners.size(), Vec2{0.5F});
  const auto thin = test::frame_of(source);
  for (const char* kernel : {"ray", "lightcuts", "brute"}) {
    const Estimate all = at_the_middle(*opaque, kernel);
    EXPECT_GT(all.mean, 0.0);
    for (const auto& [scene, share] : {std::pair{blended, 0.3}, {thin, 0.3 * 0.2}}) {
      const Estimate part = at_the_middle(*scene, kernel);
      EXPECT_NEAR(part.mean, share * all.mean,
                  4.0 * std::hypot(part.standard_error, share * all.standard_error))
          << kernel;
    }
  }
}

// ---- scale ----

scene::Scene scaled(scene::Scene scene, double factor) {
  const auto square = static_cast<float>(factor * factor);
  for (scene::Instance& instance : scene.instances) {
    instance.parent_from_object =
        glm::scale(DMat4{1.0}, DVec3{factor}) * instance.parent_from_object;
  }
  for (scene::Light& light : scene.lights) light.position *= factor, light.intensity *= square;
  scene.settings.ambient_distance_m *= factor;
  return scene;
}

TEST(Scale, ASceneOfAnySizeGivesTheSamePicture) {
  const auto view = test::view_on(foveation::make_uniform_grid(test::display(32)));
  kernels::TileScheduler scheduler;
  for (const char* kernel : kKernels) {
    scene::Scene room = room_under_a_sky();
    const auto unscaled = test::render(kernel, exact(4, 2), *test::frame_of(room), view, scheduler);
    for (const double factor : {1e-6, 1e-3, 1e3, 1e6}) {
      const auto frame = test::frame_of(scaled(room, factor));
      const auto render = test::render(kernel, exact(4, 2), *frame, view, scheduler);
      double sum = 0.0;
      for (std::size_t i = 0; i < render.planes().radiance.size(); ++i) {
        const DVec3 reference(unscaled.planes().radiance.pixels()[i]);
        const DVec3 difference = DVec3(render.planes().radiance.pixels()[i]) - reference;
        sum += glm::dot(difference * difference / (reference * reference + 1e-2), DVec3{1.0 / 3.0});
      }
      EXPECT_LT(sum / static_cast<double>(render.planes().radiance.size()), 1e-3)
          << kernel << " at " << factor;
    }
  }
}

}  // namespace
}  // namespace macula
