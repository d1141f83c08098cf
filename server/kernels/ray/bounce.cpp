#include "server/kernels/ray/bounce.h"

#include <algorithm>
#include <array>
#include <memory>

#include "server/kernels/ray/shading_point.h"

namespace macula::kernels::ray {

Config lamps_alone(const Config& config) {
  Config lamps = config;
  lamps.virtual_lights = {};
  lamps.lights = LightChoice::Every;
  lamps.ambient_samples = lamps.environment_samples = 0;
  return lamps;
}

void bounce(const visibility::RayStream& rays, std::span<const sampling::SampleKey> keys,
            const SceneFrame& scene, const Config& config, visibility::HitStream& hits,
            std::span<Rgb> radiance, LightingWork& work) {
  const Config lamps = lamps_alone(config);
  scene.intersect(rays, hits, visibility::Coherence::Incoherent);
  const auto points = std::make_unique<LitPoints>();
  std::array<std::uint16_t, sampling::kBatch> owner;
  std::array<Rgb, sampling::kBatch> lit{};
  std::ranges::fill(radiance, Rgb{0.0F});
  for (int i = 0; i < rays.count; ++i) {
    if (!hits.hit(i)) continue;
    const Vec3 ray = rays.direction(i);
    ShadingRequest request;
    request.surface = scene.surface(hits.at(i), DVec3(rays.origin(i) + hits.t[i] * ray));
    request.to_eye = -ray;
    owner[points->count] = static_cast<std::uint16_t>(i);
    points->push(request.surface, shade_point(request, scene, lamps).reflector,
                 keys[static_cast<std::size_t>(i)]);
  }
  Lighting(scene, lamps).add(*points, {lit.data(), points->count}, work);
  for (std::size_t k = 0; k < points->count; ++k)
    if (math::is_finite(lit[k])) radiance[owner[k]] = lit[k];
}

}  // namespace macula::kernels::ray
