// Direct light against independent renderers' pictures: Lambert, no bounce, box filter.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "server/exr/exr.h"
#include "server/sampling/frame.h"
#include "server/sampling/mappings.h"
#include "server/scene/load.h"
#include "server/visibility/ray_offset.h"
#include "shared/math/hash.h"
#include "tests/conformance/polygon_light.h"
#include "tests/conformance/test_scenes.h"
#include "tests/support/handed_data.h"

namespace macula {
namespace {

using image::Plane;

double quantile(const Plane<Rgb>& picture, double q) {
  std::vector<float> values;
  for (const Rgb& value : picture.pixels()) values.push_back(image::luminance(value));
  const auto nth =
      values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size()));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

/// RMS luminance difference over the cells that are not marked.
double rms_outside(const Plane<std::uint8_t>& marked, const Plane<Rgb>& a, const Plane<Rgb>& b,
                   double gain = 1.0) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (marked.pixels()[i] != 0) continue;
    const double difference =
        gain * image::luminance(a.pixels()[i]) - image::luminance(b.pixels()[i]);
    sum += difference * difference;
    ++count;
  }
  return std::sqrt(sum / count);
}

/// The picture of a box filter `factor` times as wide.
Plane<Rgb> reduced(const Plane<Rgb>& picture, int factor) {
  Plane<Rgb> small(picture.width() / factor, picture.height() / factor);
  for (int y = 0; y < small.height(); ++y) {
    for (int x = 0; x < small.width(); ++x) {
      DVec3 sum{0.0};
      for (int j = 0; j < factor * factor; ++j) {
        sum += DVec3(picture(factor * x + j % factor, factor * y + j / factor));
      }
      small(x, y) = Rgb(sum / static_cast<double>(factor * factor));
    }
  }
  return small;
}

/// Marks the cells of `factor` x `factor` pixels that hold one above the picture's 99th percentile:
/// lamps and their edges, whose few cells would outweigh all others.
Plane<std::uint8_t> lamps_in(const Plane<Rgb>& picture, int factor) {
  const double limit = quantile(picture, 0.99);
  Plane<std::uint8_t> marked(picture.width() / factor, picture.height() / factor);
  for (int y = 0; y < marked.height() * factor; ++y) {
    for (int x = 0; x < marked.width() * factor; ++x) {
      if (image::luminance(picture(x, y)) > limit) marked(x / factor, y / factor) = 1;
    }
  }
  return marked;
}

Plane<Rgb> reference_picture(const std::string& file) {
  const auto picture = exr::read((test::handed_data() / "scenes" / file).string());
  EXPECT_TRUE(picture) << (picture ? "" : picture.error().message());
  return picture ? *picture : Plane<Rgb>(1, 1);
}

/// Who renders, and how well: samples a cell, light samples a sample.
struct Effort {
  const char* kernel;
  int samples, light_samples;
};

kernels::KernelOptions direct_light(const Effort& effort) {
  kernels::KernelOptions options;
  options.mode = kernels::Mode::Exact;
  options.samples_per_cell = effort.samples;
  options.area_light_samples = options.environment_samples = effort.light_samples;
  options.lambert_only = true;
  return options;
}

/// A reference picture as cells of 4 x 4 of its pixels.
struct Reference {
  Plane<Rgb> cells;
  Plane<std::uint8_t> lamps;
  double noise;  ///< RMS of a cell's luminance outside the lamps
};
/// `noise`: of the luminance of one pixel.
Reference reference_of(const Plane<Rgb>& picture, double noise) {
  constexpr int kFactor = 4;
  return {reduced(picture, kFactor), lamps_in(picture, kFactor), noise / kFactor};
}

/// Whether the noise is low enough for the differences to show a picture 5 % too bright; its mean
/// shows it in any case.
enum class Sees { MeansOnly, FivePercent };

/// Means within 2 %, differences within 1.15 of what the noise of both explains. Over several
/// pictures, because a few cells on silhouettes hold most of the noise.
void expect_agreement(const kernels::SceneFrame& scene, const kernels::View& view,
                      const Effort& effort, const Reference& reference,
                      Sees sees = Sees::FivePercent) {
  constexpr int kPictures = 6;
  kernels::TileScheduler scheduler;
  std::vector<Plane<Rgb>> pictures;
  Plane<Rgb> middle(reference.cells.width(), reference.cells.height());
  for (int i = 0; i < kPictures; ++i) {
    pictures.push_back(
        test::render(effort.kernel, direct_light(effort), scene, view, scheduler, 1 + i)
            .planes()
            .radiance);
    for (std::size_t k = 0; k < middle.size(); ++k)
      middle.pixels()[k] += pictures.back().pixels()[k] / static_cast<float>(kPictures);
  }
  const DVec3 wanted = test::mean(reference.cells), got = test::mean(middle);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c] / wanted[c], 1.0, 0.02) << effort.kernel;
  const auto rms_to = [&](const Plane<Rgb>& other, double gain) {
    double sum = 0.0;
    for (const Plane<Rgb>& picture : pictures)
      sum += std::pow(rms_outside(reference.lamps, picture, other, gain), 2);
    return std::sqrt(sum / kPictures);
  };
  const double own = rms_to(middle, 1.0) * std::sqrt(kPictures / (kPictures - 1.0));
  const double allowed = 1.15 * std::hypot(reference.noise, own);
  EXPECT_LE(rms_to(reference.cells, 1.0), allowed) << effort.kernel;
  if (sees == Sees::MeansOnly) return;
  EXPECT_GT(rms_to(reference.cells, 1.05), allowed)
      << effort.kernel << ": a picture 5 % too bright must be seen";
}

kernels::View view_of(const scene::Camera& camera, int side_px) {
  kernels::View view = test::view_on(foveation::make_uniform_grid(
      {math::symmetric_fov(camera.vertical_fov, 1.0), side_px, side_px}));
  view.world_from_view = camera.parent_from_view;
  return view;
}

TEST(DirectReference, CornellBoxAgreesWithinItsNoise) {
  MACULA_NEEDS_HANDED_DATA("scenes/cornell_box/reference/direct_lambert_256.exr");
  const auto loaded =
      scene::load_scene((test::handed_data() / "scenes/cornell_box/cornell_box.gltf").string());
  ASSERT_TRUE(loaded) << loaded.error().message();
  const auto frame = *kernels::SceneFrame::create(*loaded);
  const Reference reference =
      reference_of(reference_picture("cornell_box/reference/direct_lambert_256.exr"), 0.000125);
  const kernels::View view = view_of((*loaded)->cameras.front(), 64);
  for (const Effort& effort : {Effort{"ray", 144, 4}, Effort{"brute", 144, 2}}) {
    expect_agreement(*frame, view, effort, reference);
  }
}

TEST(DirectReference, ModernHallAgreesWithinItsNoise) {
  MACULA_NEEDS_HANDED_DATA("scenes/modern_hall/reference/direct_lambert_256.exr");
  const auto loaded =
      scene::load_scene((test::handed_data() / "scenes/modern_hall/modern_hall.gltf").string());
  ASSERT_TRUE(loaded) << loaded.error().message();
  const auto frame = *kernels::SceneFrame::create(*loaded);
  const Reference reference =
      reference_of(reference_picture("modern_hall/reference/direct_lambert_256.exr"), 0.004085);
  const kernels::View view = view_of((*loaded)->cameras.front(), 64);
  // Kernel brute's noise here would hide 2 % of the mean in a run of seconds.
  for (const Effort& effort : {Effort{"ray", 64, 4}}) {
    expect_agreement(*frame, view, effort, reference, Sees::MeansOnly);
  }
}

// ---- ignis_direct: the scenes of its XML files ----

/// RMS noise of a picture that is smooth almost everywhere, from second differences along its rows:
/// the median of |a - 2 b + c| is 0.6745 sqrt(6) of a normal error.
double noise_of(const Plane<Rgb>& picture) {
  std::vector<double> bends;
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 1; x + 1 < picture.width(); ++x) {
      const double middle = image::luminance(picture(x, y));
      const double bend =
          image::luminance(picture(x - 1, y)) - 2.0 * middle + image::luminance(picture(x + 1, y));
      if (middle > 0.0) bends.push_back(std::abs(bend));
    }
  }
  const auto half = bends.begin() + static_cast<std::ptrdiff_t>(bends.size() / 2);
  std::nth_element(bends.begin(), half, bends.end());
  return *half / (0.6745 * std::sqrt(6.0));
}

/// The plane of Bottom.ply, which all three scenes have.
scene::Scene ignis_floor() {
  scene::Scene scene;
  scene.materials.resize(2);
  scene.materials[0].base_color = {0.885809F, 0.698859F, 0.666422F};
  scene.materials[0].specular = scene.materials[1].specular = 0.0F;
  scene.materials[1].base_color = Rgb{0.0F};
  test::add_quad(scene, {-1, -1, 1}, {2, 0, 0}, {0, 0, -2}, 0);
  return scene;
}
/// That of Top.ply, shining down.
void add_ignis_panel(scene::Scene& scene, float radiance) {
  scene.materials[1].emission = Rgb{radiance};
  test::add_quad(scene, {-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, 1);
}
void add_point_light(scene::Scene& scene, const DVec3& position, const Rgb& intensity) {
  scene::Light light;
  light.position = position;
  light.intensity = intensity;
  scene.lights.push_back(light);
}

/// At (0, 0, -2) looking along +Z: image right is -X, as in the references.
kernels::View ignis_view(int side_px) {
  kernels::View view = test::view_on(foveation::make_uniform_grid(test::display(side_px, 90.0)));
  view.world_from_view = {{0.0, 0.0, -2.0}, glm::angleAxis(std::numbers::pi, DVec3{0.0, 1.0, 0.0})};
  return view;
}

void expect_ignis_agreement(scene::Scene scene, const std::string& reference_file) {
  const auto full = reference_picture("ignis_direct/" + reference_file);
  const Reference reference = reference_of(full, noise_of(full));
  const auto frame = test::frame_of(std::move(scene));
  for (const Effort& effort : {Effort{"ray", 144, 2}, Effort{"brute", 144, 2}}) {
    expect_agreement(*frame, ignis_view(64), effort, reference);
  }
}

TEST(IgnisReference, APointLightOverAPlane) {
  MACULA_NEEDS_HANDED_DATA("scenes/ignis_direct/ref-point-4096.exr");
  scene::Scene scene = ignis_floor();
  add_point_light(scene, {0.0, 1.0, 0.0}, Rgb{1.0F});
  expect_ignis_agreement(std::move(scene), "ref-point-4096.exr");
}

TEST(IgnisReference, AnEmissivePlaneOverAPlane) {
  MACULA_NEEDS_HANDED_DATA("scenes/ignis_direct/ref-emissive-plane-4096.exr");
  scene::Scene scene = ignis_floor();
  add_ignis_panel(scene, 1.0F);
  expect_ignis_agreement(std::move(scene), "ref-emissive-plane-4096.exr");
}

TEST(IgnisReference, APanelTwoPointLightsAndAConstantEnvironment) {
  MACULA_NEEDS_HANDED_DATA("scenes/ignis_direct/ref-multilight-4096.exr");
  scene::Scene scene = ignis_floor();
  add_ignis_panel(scene, 0.5F);
  add_point_light(scene, {-1.0, 0.25, 0.0}, {0.1F, 0.2F, 1.0F});
  add_point_light(scene, {1.0, 0.25, 0.0}, {1.0F, 0.2F, 0.1F});
  scene.environment = scene::Environment{};
  scene.environment->radiance(0, 0) = Rgb{0.2F};
  expect_ignis_agreement(std::move(scene), "ref-multilight-4096.exr");
}

// ---- points lit by many emissive triangles ----

/// A point of the scene seen through a camera, with its Lambertian reflectance.
struct SeenPoint {
  kernels::SurfacePoint point;
  shading::Surface surface;
  shading::ShadingFrame frame;
  DVec3 reflectance{0.0};

  Vec3 leave() const {
    return visibility::offset_ray_origin(Vec3(surface.position), frame.geometric, 0.0F,
                                         surface.span_m);
  }
};
std::optional<SeenPoint> seen(const kernels::SceneFrame& scene, const Pose& eye,
                              const Vec3& view_direction) {
  const Vec3 direction(glm::normalize(eye.transform_direction(DVec3(view_direction))));
  const auto hit = scene.triangles().intersect(visibility::Ray{Vec3(eye.position), direction});
  if (!hit) return std::nullopt;
  SeenPoint seen;
  seen.surface = scene.surfaces().at(hit->instance, hit->triangle, {hit->u, hit->v});
  seen.frame = shading::make_shading_frame(seen.surface.geometric_normal,
                                           seen.surface.shading_normal, -direction);
  seen.reflectance =
      DVec3(scene.materials()
                .bsdf(seen.surface.material, seen.surface.uv, 0.0F, shading::MaterialModel::Lambert)
                .albedo);
  seen.point = {seen.surface.position, seen.frame.geometric, -direction,
                hit->instance,         hit->triangle,        {hit->u, hit->v}};
  return seen;
}

struct Mean {
  double value = 0.0, standard_error = 0.0;
};
/// Luminance that `kernel` finds leaving the point, over independent samples.
Mean by_kernel(const kernels::SceneFrame& scene, const SeenPoint& seen, const Effort& effort) {
  std::vector<kernels::SurfacePoint> points(static_cast<std::size_t>(effort.samples), seen.point);
  for (std::size_t i = 0; i < points.size(); ++i) points[i].key = math::hash_mix(i + 1);
  std::vector<Rgb> radiance(points.size());
  kernels::TileScheduler scheduler;
  (*kernels::make_kernel(effort.kernel, direct_light({effort.kernel, 1, effort.light_samples})))
      ->shade(points, scene, scheduler, radiance);
  double sum = 0.0, square = 0.0;
  for (const Rgb& value : radiance) {
    const double luminance = image::luminance(value);
    sum += luminance, square += luminance * luminance;
  }
  const auto n = static_cast<double>(points.size());
  return {sum / n, std::sqrt((square / n - sum * sum / n / n) / n)};
}

/// The same without any light sampling: the emission that cosine-distributed rays run into.
Mean by_rays_alone(const kernels::SceneFrame& scene, const SeenPoint& seen, int rays) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform;
  const Mat3 frame = sampling::frame_from_normal(seen.frame.shading);
  double sum = 0.0, square = 0.0;
  for (int i = 0; i < rays; ++i) {
    const Vec3 direction = frame * sampling::cosine_hemisphere({uniform(random), uniform(random)});
    const auto hit = scene.triangles().intersect(visibility::Ray{seen.leave(), direction});
    if (!hit || glm::dot(hit->normal, direction) >= 0.0F) continue;
    const auto lamp = scene.surfaces().at(hit->instance, hit->triangle, {hit->u, hit->v});
    const DVec3 light =
        seen.reflectance * DVec3(scene.materials().emission(lamp.material, lamp.uv, 0.0F));
    const double luminance = image::luminance(Rgb(light));
    sum += luminance, square += luminance * luminance;
  }
  const double n = rays;
  return {sum / n, std::sqrt((square / n - sum * sum / n / n) / n)};
}

// At points of bistro_interior's floor; bistro_reference_test.cpp compares whole pictures.
TEST(DirectReference, InTheBistroLampsAreFoundByLightSamplingAsByRaysAlone) {
  MACULA_NEEDS_HANDED_DATA("scenes/bistro_interior/bistro_interior.gltf");
  const auto loaded = scene::load_scene(
      (test::handed_data() / "scenes/bistro_interior/bistro_interior.gltf").string());
  ASSERT_TRUE(loaded) << loaded.error().message();
  const auto frame = *kernels::SceneFrame::create(*loaded);
  const Pose eye = (*loaded)->cameras.front().parent_from_view;
  for (const Vec3& direction : {Vec3{-0.1F, -0.25F, -1}, Vec3{0.2F, -0.3F, -1}}) {
    const auto point = seen(*frame, eye, direction);
    ASSERT_TRUE(point);
    const Mean rays = by_rays_alone(*frame, *point, 700'000);
    for (const Effort& effort : {Effort{"ray", 40'000, 4}, Effort{"brute", 40'000, 4}}) {
      const Mean sampled = by_kernel(*frame, *point, effort);
      const double error = std::hypot(sampled.standard_error, rays.standard_error);
      // brute draws all 41,753 triangles alike, which costs it three times the error.
      EXPECT_LT(error, 0.06 * rays.value) << effort.kernel;
      EXPECT_NEAR(sampled.value, rays.value, 4.0 * error) << effort.kernel;
    }
  }
}

/// No ray from the point to any emissive triangle's corners is interrupted, but by the lamps.
bool sees_all_lamps(const kernels::SceneFrame& scene, const SeenPoint& seen) {
  for (const lights::EmissiveTriangle& lamp : scene.lights().emissive()) {
    const Vec3 towards(lamp.position - DVec3(seen.leave()));
    if (glm::dot(towards, seen.frame.geometric) <= 0.0F) return false;
    const auto hit = scene.triangles().intersect(visibility::Ray{seen.leave(), towards});
    if (hit && !scene.materials().emits(scene.surfaces().material(hit->instance))) return false;
  }
  return true;
}

// Convex lamps hide nothing of each other's fronts where all of them are seen, so the polygon
// formula over the triangles that face the point is exact.
TEST(VeachScene, SphericalLampsGiveTheSumOfTheirPolygons) {
  MACULA_NEEDS_HANDED_DATA("scenes/veach_mis/veach_mis.gltf");
  const auto loaded =
      scene::load_scene((test::handed_data() / "scenes/veach_mis/veach_mis.gltf").string());
  ASSERT_TRUE(loaded) << loaded.error().message();
  const auto frame = *kernels::SceneFrame::create(*loaded);
  const scene::Camera& camera = (*loaded)->cameras.front();
  int points = 0;
  for (float y = -0.15F; y <= 0.15F; y += 0.03F) {
    const auto point = seen(*frame, camera.parent_from_view, {0.12F, y, -1.0F});
    if (!point || glm::dot(point->reflectance, DVec3{1.0}) == 0.0 || points == 4) continue;
    if (!sees_all_lamps(*frame, *point)) continue;
    ++points;
    DVec3 expected{0.0};
    for (const lights::EmissiveTriangle& lamp : frame->lights().emissive()) {
      const DVec3 corner = lamp.position;
      if (glm::dot(DVec3(lamp.normal), point->surface.position - corner) <= 0.0) continue;
      expected += DVec3(lamp.mean_emission) *
                  test::polygon_irradiance(
                      point->surface.position, DVec3(point->frame.shading),
                      {corner, corner + DVec3(lamp.edge1), corner + DVec3(lamp.edge2)});
    }
    const double radiance = image::luminance(Rgb(point->reflectance * expected / std::numbers::pi));
    const Mean brute = by_kernel(*frame, *point, {"brute", 20'000, 4});
    EXPECT_NEAR(brute.value, radiance, 4.0 * brute.standard_error + 1e-3 * radiance);
    EXPECT_LT(brute.standard_error, 0.02 * radiance);
  }
  EXPECT_GE(points, 2) << "too few points see all lamps";
}

}  // namespace
}  // namespace macula
