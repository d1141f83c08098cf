#include "server/kernels/sphere/hit_shader.h"

#include <limits>

namespace macula::kernels::sphere {

bool met_surface(const sdf::Hit& hit) {
  return hit.status == sdf::RayStatus::Hit || hit.status == sdf::RayStatus::Inside;
}

ShadedHit HitShader::without_surface(const sdf::Hit& hit) const {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  if (hit.status == sdf::RayStatus::Inside) return {hit, 0.0F, Rgb{0.0F}, Rgb{0.0F}};
  return {hit, kInfinity, context_.scene.scene().settings.ambient, Rgb{0.0F}};
}

void HitShader::gather(std::span<const sdf::Hit> hits) {
  const bool random = context_.config.lighting.sky == SkyLight::Traced;
  std::size_t n = 0;
  for (const sdf::Hit& hit : hits) {
    if (hit.status != sdf::RayStatus::Hit) continue;
    surfaces_.position.set(n, hit.direction);
    surfaces_.normal.set(n, hit.normal);
    ways_.at[n] = hit.t;
    const Vec2 cell = grid_.footprint(hit.x, hit.y);
    surfaces_.cell_m.at[n] = cell.x * cell.y;
    surfaces_.material[n] = static_cast<scene::Index>(hit.material);
    if (random) {
      surfaces_.keys[n] =
          sampling::SampleKey(context_.seed, context_.frame, grid_.cell_key(hit.x, hit.y));
      surfaces_.sample[n] = hit.sample;
    }
    ++n;
  }
  surfaces_.count = n;
  const bool exact = context_.config.mode == Mode::Exact;
  place_surfaces(ways_, context_.forward, exact ? 0.0F : per_sample_, surfaces_, depth_);
}

void HitShader::light(std::span<const sdf::Hit> hits) {
  gather(hits);
  if (surfaces_.count == 0) return;
  context_.lighting.light(surfaces_, occlusion_, lit_);
  non_finite_ += blacken_non_finite(surfaces_.count, lit_.radiance);
}

}  // namespace macula::kernels::sphere
