#include "server/kernels/sphere/lighting.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/sampling/mappings.h"
#include "server/sampling/sobol.h"
#include "server/shading/pattern.h"

namespace macula::kernels::sphere {
namespace {

using sampling::Vec3Batch;

/// Which of the materials some point has.
class Present {
 public:
  Present(const SurfaceBatch& points, std::size_t materials) : has_(materials, 0) {
    for (std::size_t i = 0; i < points.count; ++i) has_[points.material[i]] = 1;
  }
  bool operator[](std::size_t material) const { return has_[material] != 0; }

 private:
  std::vector<std::uint8_t> has_;
};

}  // namespace

Lighting::Lighting(const SceneFrame& scene, const Config& config, const DVec3& eye)
    : scene_(scene), config_(config), eye_(eye) {
  for (scene::Light light : scene.lights().punctual()) {
    light.position -= eye;
    lights_.push_back(light);
  }
  for (const scene::Material& material : scene.scene().materials)
    rows_.push_back(row_of(material, static_cast<scene::Index>(rows_.size())));
}

Lighting::Row Lighting::row_of(const scene::Material& material, scene::Index index) const {
  const shading::MaterialTable& table = scene_.materials();
  Row row;
  row.matte.base = row.matte.second = material.base_color;
  row.pattern = material.pattern;
  if (row.pattern) row.matte.second = row.pattern->second_color;
  row.matte.emission = table.emission(index, Vec2{0.0F}, 0.0F);
  // The diffuse albedo is a share of the base colour that does not depend on it.
  row.matte.diffuse = table.bsdf(index, Rgb{1.0F}, config_.materials).albedo.x;
  for (const Rgb& color : {row.matte.base, row.matte.second})
    row.glossy = row.glossy || table.bsdf(index, color, config_.materials).glossy();
  return row;
}

void Lighting::light(const SurfaceBatch& points, Occlusion& occlusion, LitBatch& lit) const {
  set_reflectors(points, lit);
  add_sky(points, occlusion, lit);
  for (const scene::Light& light : lights_) add_light(light, points, occlusion, lit);
}

void Lighting::set_reflectors(const SurfaceBatch& points, LitBatch& lit) const {
  const Present present(points, rows_.size());
  cover(points, eye_, lit);
  face_eye(points, lit);
  bool glossy = false;
  for (std::size_t m = 0; m < rows_.size(); ++m) {
    if (!present[m]) continue;
    const Row& row = rows_[m];
    if (row.pattern)
      shading::second_shares(*row.pattern, {lit.world, points.normal, lit.box, points.count},
                             lit.share);
    take_matte(points, static_cast<scene::Index>(m), row.matte, row.pattern ? &lit.share : nullptr,
               lit);
    glossy = glossy || row.glossy;
  }
  if (glossy) set_lobes(points, lit);
}

void Lighting::set_lobes(const SurfaceBatch& points, LitBatch& lit) const {
  for (std::size_t i = 0; i < points.count; ++i) {
    if (!rows_[points.material[i]].glossy) continue;
    const shading::Bsdf bsdf =
        scene_.materials().bsdf(points.material[i], lit.base_color[i], config_.materials);
    if (!bsdf.glossy()) continue;
    const Vec3 seen = lit.reflectors.shading[i];
    lit.reflectors.set(
        i, shading::Reflector(bsdf, shading::make_shading_frame(seen, seen, points.to_eye[i])));
  }
}

void Lighting::add_light(const scene::Light& light, const SurfaceBatch& points,
                         Occlusion& occlusion, LitBatch& lit) const {
  lights::arriving(light, points.position, points.count, lit.arrival);
  shading::reflect(lit.reflectors, lit.arrival.to_light, lit.arrival.irradiance, points.count,
                   lit.reflected);
  if (config_.lighting.shadows == Shadows::None)
    return add(lit.reflected, nullptr, points.count, lit.radiance);
  sampling::FloatBatch distance{}, brings{};
  const bool far = light.kind == scene::LightKind::Directional;
  for (std::size_t i = 0; i < points.count; ++i) {
    brings.at[i] = lit.reflected[i] == Rgb{0.0F} ? 0.0F : 1.0F;
    distance.at[i] = far ? std::numeric_limits<float>::infinity()
                         : glm::length(Vec3(light.position) - points.position[i]);
  }
  const bool soft = config_.lighting.shadows == Shadows::Soft;
  const double radius = soft ? std::tan(Radians{config_.lighting.light_radius}.value()) : 0.0;
  std::fill_n(lit.share.at, points.count, 0.0F);
  occlusion.light(points, lit.arrival.to_light, distance, static_cast<float>(radius), brings,
                  lit.share);
  add(lit.reflected, &lit.share, points.count, lit.radiance);
}

void Lighting::add_sky(const SurfaceBatch& points, Occlusion& occlusion, LitBatch& lit) const {
  const Rgb& sky = scene_.scene().settings.ambient;
  const SkyLight how = config_.lighting.sky;
  if (how == SkyLight::None || sky == Rgb{0.0F}) return;
  if (how == SkyLight::Near)
    occlusion.near_sky(points, static_cast<float>(config_.lighting.near_sky_m), lit.share);
  if (how == SkyLight::Traced) traced_sky(points, lit.reflectors, occlusion, lit.share);
  add_reflected(sky, lit.reflectors.reflectance, how == SkyLight::All ? nullptr : &lit.share,
                points.count, lit.radiance);
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
