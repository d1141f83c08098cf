#include "server/kernels/sphere/hit_shader.h"

#include <limits>

#include "shared/math/vec.h"

namespace macula::kernels::sphere {

bool met_surface(const sdf::Hit& hit) {
  return hit.status == sdf::RayStatus::Hit || hit.status == sdf::RayStatus::Inside;
}

void HitShader::gather(std::span<const sdf::Hit> hits) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const bool exact = context_.config.mode == Mode::Exact;
  const bool random = context_.config.lighting.sky == SkyLight::Traced;
  std::size_t n = 0;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const sdf::Hit& hit = hits[i];
    radiance_[i] = context_.scene.scene().settings.ambient, albedo_[i] = Rgb{0.0F};
    depth_[i] = kInfinity;
    if (hit.status == sdf::RayStatus::Inside) radiance_[i] = Rgb{0.0F}, depth_[i] = 0.0F;
    if (hit.status != sdf::RayStatus::Hit) continue;
    depth_[i] = hit.t * glm::dot(hit.direction, context_.forward);
    surfaces_.position.set(n, hit.t * hit.direction);
    surfaces_.normal.set(n, hit.normal);
    surfaces_.to_eye.set(n, -hit.direction);
    const Vec2 cell = grid_.footprint(hit.x, hit.y);
    surfaces_.cell_m.at[n] = std::sqrt(cell.x * cell.y) * depth_[i];
    surfaces_.footprint_m.at[n] = exact ? 0.0F : surfaces_.cell_m.at[n] * per_sample_;
    if (random) {
      surfaces_.keys[n] =
          sampling::SampleKey(context_.seed, context_.frame, grid_.cell_key(hit.x, hit.y));
      surfaces_.sample[n] = hit.sample;
    }
    surfaces_.material[n] = static_cast<scene::Index>(hit.material);
    owner_[n++] = static_cast<std::uint16_t>(i);
  }
  surfaces_.count = n;
}

void HitShader::light(std::span<const sdf::Hit> hits) {
  gather(hits);
  const std::size_t n = surfaces_.count;
  if (n == 0) return;
  const std::span albedo(surface_albedo_.data(), n), radiance(surface_radiance_.data(), n);
  context_.lighting.base_colors(surfaces_, albedo);
  context_.lighting.radiance(surfaces_, albedo, occlusion_, radiance);
  for (std::size_t i = 0; i < n; ++i) {
    const bool finite = math::is_finite(radiance[i]);
    non_finite_ += finite ? 0 : 1;
    radiance_[owner_[i]] = finite ? radiance[i] : Rgb{0.0F};
    albedo_[owner_[i]] = albedo[i];
  }
}

}  // namespace macula::kernels::sphere
