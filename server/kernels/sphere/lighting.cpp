#include "server/kernels/sphere/lighting.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "server/sampling/mappings.h"
#include "server/sampling/sobol.h"
#include "shared/base/check.h"

namespace macula::kernels::sphere {
namespace {

using sampling::Vec3Batch;

void set_all(shading::ReflectorBatch& reflectors, std::size_t i, const Vec3& normal,
             const Vec3& to_eye) {
  reflectors.shading.set(i, normal);
  reflectors.geometric.set(i, normal);
  reflectors.to_eye.set(i, to_eye);
}

/// A surface without a lobe: the same in every direction.
void set_matte(shading::ReflectorBatch& reflectors, std::size_t i, const Rgb& albedo) {
  reflectors.diffuse.set(i, albedo * std::numbers::inv_pi_v<float>);
  reflectors.reflectance.set(i, albedo);
  reflectors.f0.set(i, Rgb{0.0F});
  reflectors.f90.at[i] = 0.0F;
  reflectors.cos_v.at[i] = 1.0F;
  reflectors.alpha.at[i] = 0.0F;
}

}  // namespace

Lighting::Lighting(const SceneFrame& scene, const Config& config, const DVec3& eye)
    : scene_(scene), config_(config), eye_(eye) {
  for (scene::Light light : scene.lights().punctual()) {
    light.position -= eye;
    lights_.push_back(light);
  }
}

void Lighting::base_colors(const SurfaceBatch& points, std::span<Rgb> out) const {
  MACULA_DCHECK(out.size() == points.count);
  for (std::size_t i = 0; i < points.count; ++i) {
    const Vec3 normal = points.normal[i];
    const Vec3 box = shading::covered_box(normal, points.to_eye[i], points.footprint_m.at[i]);
    out[i] =
        scene_.materials().base_color(points.material[i], {eye_ + points.position[i], normal, box});
  }
}

void Lighting::set_reflectors(const SurfaceBatch& points, std::span<const Rgb> base_colors,
                              shading::ReflectorBatch& reflectors) const {
  for (std::size_t i = 0; i < points.count; ++i) {
    const shading::Bsdf bsdf =
        scene_.materials().bsdf(points.material[i], base_colors[i], config_.materials);
    const Vec3 normal = points.normal[i], to_eye = points.to_eye[i];
    const Vec3 seen = glm::dot(normal, to_eye) < 0.0F ? -normal : normal;
    if (bsdf.glossy()) {
      reflectors.set(i, shading::Reflector(bsdf, shading::make_shading_frame(seen, seen, to_eye)));
    } else {
      set_all(reflectors, i, seen, to_eye);
      set_matte(reflectors, i, bsdf.albedo);
    }
  }
}

void Lighting::radiance(const SurfaceBatch& points, std::span<const Rgb> base_colors,
                        Occlusion& occlusion, std::span<Rgb> radiance) const {
  MACULA_DCHECK(radiance.size() == points.count && base_colors.size() == points.count);
  shading::ReflectorBatch reflectors{};
  set_reflectors(points, base_colors, reflectors);
  for (std::size_t i = 0; i < points.count; ++i)
    radiance[i] = scene_.materials().emission(points.material[i], Vec2{0.0F}, 0.0F);
  add_sky(points, reflectors, occlusion, radiance);
  for (const scene::Light& light : lights_)
    add_light(light, points, reflectors, occlusion, radiance);
}

void Lighting::add_light(const scene::Light& light, const SurfaceBatch& points,
                         const shading::ReflectorBatch& reflectors, Occlusion& occlusion,
                         std::span<Rgb> radiance) const {
  lights::ArrivalBatch arrival{};
  Vec3Batch reflected{};
  lights::arriving(light, points.position, points.count, arrival);
  shading::reflect(reflectors, arrival.to_light, arrival.irradiance, points.count, reflected);
  if (config_.lighting.shadows == Shadows::None) {
    for (std::size_t i = 0; i < points.count; ++i) radiance[i] += reflected[i];
    return;
  }
  sampling::FloatBatch distance{}, brings{}, reaching{};
  const bool far = light.kind == scene::LightKind::Directional;
  for (std::size_t i = 0; i < points.count; ++i) {
    brings.at[i] = reflected[i] == Rgb{0.0F} ? 0.0F : 1.0F;
    distance.at[i] = far ? std::numeric_limits<float>::infinity()
                         : glm::length(Vec3(light.position) - points.position[i]);
  }
  const bool soft = config_.lighting.shadows == Shadows::Soft;
  const double radius = soft ? std::tan(Radians{config_.lighting.light_radius}.value()) : 0.0;
  occlusion.light(points, arrival.to_light, distance, static_cast<float>(radius), brings, reaching);
  for (std::size_t i = 0; i < points.count; ++i) radiance[i] += reaching.at[i] * reflected[i];
}

void Lighting::add_sky(const SurfaceBatch& points, const shading::ReflectorBatch& reflectors,
                       Occlusion& occlusion, std::span<Rgb> radiance) const {
  const Rgb& sky = scene_.scene().settings.ambient;
  if (config_.lighting.sky == SkyLight::None || sky == Rgb{0.0F}) return;
  sampling::FloatBatch reaching{};
  std::fill_n(reaching.at, points.count, 1.0F);
  if (config_.lighting.sky == SkyLight::Near)
    occlusion.near_sky(points, static_cast<float>(config_.lighting.near_sky_m), reaching);
  if (config_.lighting.sky == SkyLight::Traced) traced_sky(points, reflectors, occlusion, reaching);
  for (std::size_t i = 0; i < points.count; ++i)
    radiance[i] += reaching.at[i] * sky * reflectors.reflectance[i];
}

/// The share of cosine-distributed directions about the normal that meet nothing.
void Lighting::traced_sky(const SurfaceBatch& points, const shading::ReflectorBatch& reflectors,
                          Occlusion& occlusion, sampling::FloatBatch& reaching) const {
  constexpr std::uint32_t kSkyDimension = 0x8000'0001U;
  const int count = config_.lighting.sky_samples;
  sampling::FloatBatch infinite{}, all{}, open{};
  std::fill_n(infinite.at, points.count, std::numeric_limits<float>::infinity());
  std::fill_n(all.at, points.count, 1.0F);
  std::fill_n(reaching.at, points.count, 0.0F);
  sampling::Vec2Batch u{};
  Vec3Batch directions{};
  for (int k = 0; k < count; ++k) {
    for (std::size_t i = 0; i < points.count; ++i) {
      const Vec2 point = sampling::sobol_owen_2d(
          points.sample[i] * static_cast<std::uint32_t>(count) + static_cast<std::uint32_t>(k),
          sampling::scramble_seed(points.keys[i], kSkyDimension));
      u.x[i] = point.x, u.y[i] = point.y;
    }
    sampling::cosine_directions(u, reflectors.shading, reflectors.geometric, points.count,
                                directions);
    occlusion.light(points, directions, infinite, 0.0F, all, open);
    for (std::size_t i = 0; i < points.count; ++i)
      reaching.at[i] += open.at[i] / static_cast<float>(count);
  }
}

}  // namespace macula::kernels::sphere
