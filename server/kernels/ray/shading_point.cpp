#include "server/kernels/ray/shading_point.h"

#include <algorithm>
#include <cmath>

namespace macula::kernels::ray {

float ShadingRequest::footprint_uv() const {
  const float slant = std::abs(glm::dot(surface.geometric_normal, to_eye));
  return uv_per_meter * footprint_m / std::sqrt(std::max(slant, kLeastSlant));
}

ShadedPoint shade_point(const ShadingRequest& request, const SceneFrame& scene,
                        const Config& config) {
  const shading::Surface& surface = request.surface;
  const auto& materials = scene.materials();
  const shading::SampleFootprint footprint = request.footprint();
  ShadedPoint shaded;
  if (glm::dot(surface.geometric_normal, request.to_eye) > 0.0F) {
    shaded.emission = materials.emission(surface.material, surface.uv, footprint.uv);
  }
  shaded.reflector =
      shading::Reflector(materials.bsdf(surface, footprint, config.materials),
                         shading::make_shading_frame(surface.geometric_normal,
                                                     surface.shading_normal, request.to_eye));
  return shaded;
}

void shade_batch(std::span<const SurfacePoint> points, const SceneFrame& scene,
                 const Config& config, const Lighting& lighting, std::span<Rgb> out) {
  LitPoints lit{};
  lit.keeps_whole = scene.plan().has(scene::Step::Environment) ||
                    config.virtual_lights.near_light == NearLight::Bounced;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const SurfacePoint& point = points[i];
    ShadingRequest request;
    request.surface = scene.surface(point.hit(), point.position);
    request.to_eye = point.to_eye;
    if (config.mode == Mode::Fast) {
      request.uv_per_meter = scene.uv_per_meter(point.instance, point.triangle);
      request.footprint_m = point.footprint_m;
    }
    const ShadedPoint shaded = shade_point(request, scene, config);
    out[i] = shaded.emission;
    sampling::SampleKey key;
    key.value = point.key;
    request.surface.position = point.position;
    lit.push(request.surface, shaded.reflector, key);
  }
  LightingWork work;
  lighting.add(lit, out, work);
  for (Rgb& radiance : out) {
    if (!math::is_finite(radiance)) radiance = Rgb{0.0F};
  }
}

}  // namespace macula::kernels::ray
