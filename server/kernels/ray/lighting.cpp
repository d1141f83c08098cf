#include "server/kernels/ray/lighting.h"

#include <chrono>

#include "server/sampling/frame.h"
#include "server/sampling/mappings.h"
#include "server/sampling/sobol.h"
#include "shared/base/check.h"

namespace macula::kernels::ray {
namespace {

using visibility::Coherence;

// Dimensions of a cell's random numbers; those below 2^31 place the primary samples.
constexpr std::uint32_t kAreaDimension = 0x8000'0000U;
constexpr std::uint32_t kAmbientDimension = 0x8000'0001U;

/// Rays of one term with what each would bring if nothing were in its way.
class ShadowBatch {
 public:
  void push(std::size_t owner, const Vec3& origin, const Vec3& direction, float tfar,
            const Rgb& contribution) {
    const auto i = static_cast<std::size_t>(rays_.push(origin, direction, 0.0F, tfar));
    owner_[i] = static_cast<std::uint16_t>(owner);
    contribution_[i] = contribution;
  }
  void resolve(const visibility::TriangleScene& triangles, Coherence coherence,
               std::span<Rgb> radiance, LightingWork& work) {
    if (rays_.count == 0) return;
    const auto begin = std::chrono::steady_clock::now();
    triangles.occluded(rays_, result_, coherence);
    work.trace_ms += units::to_ms(std::chrono::steady_clock::now() - begin);
    work.shadow_rays += static_cast<std::uint64_t>(rays_.count);
    for (std::size_t i = 0; i < static_cast<std::size_t>(rays_.count); ++i) {
      if (result_.occluded[i] == 0) radiance[owner_[i]] += contribution_[i];
    }
  }

 private:
  visibility::RayStream rays_;
  visibility::OcclusionStream result_;
  std::uint16_t owner_[visibility::kStreamCapacity];
  Rgb contribution_[visibility::kStreamCapacity];
};

bool is_black(const Rgb& c) {
  return c.x == 0.0F && c.y == 0.0F && c.z == 0.0F;
}

/// Where rays leave a lit point: the side of the surface that faces the eye.
Vec3 ray_origin(const LitPoint& point) {
  return visibility::offset_ray_origin(Vec3(point.position), point.reflector.frame().geometric);
}

/// Sample k of `count` at this primary sample: a consecutive stretch of the cell's one sequence, so
/// that all of a cell's samples together are stratified too.
Vec2 stratified(const LitPoint& point, std::uint32_t dimension, int k, int count) {
  const std::uint32_t index =
      point.sample * static_cast<std::uint32_t>(count) + static_cast<std::uint32_t>(k);
  return sampling::sobol_owen_2d(index, sampling::scramble_seed(point.key, dimension));
}

}  // namespace

void Lighting::add(std::span<const LitPoint> points, std::span<Rgb> radiance,
                   LightingWork& work) const {
  MACULA_DCHECK(points.size() == radiance.size());
  MACULA_DCHECK(points.size() <= visibility::kStreamCapacity);
  for (const scene::Light& light : scene_.lights().punctual()) {
    add_punctual(light, points, radiance, work);
  }
  if (!scene_.lights().emissive().empty()) {
    for (int k = 0; k < config_.area_light_samples; ++k) add_area(k, points, radiance, work);
  }
  if (!is_black(scene_.scene().settings.ambient)) {
    for (int k = 0; k < config_.ambient_samples; ++k) add_ambient(k, points, radiance, work);
  }
}

void Lighting::add_punctual(const scene::Light& light, std::span<const LitPoint> points,
                            std::span<Rgb> radiance, LightingWork& work) const {
  ShadowBatch batch;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto arrival = lights::arriving(light, points[i].position);
    if (!arrival) continue;
    const Rgb reflected = points[i].reflector.evaluate(arrival->to_light) * arrival->irradiance;
    if (is_black(reflected)) continue;
    const Vec3 origin = ray_origin(points[i]);
    if (light.kind == scene::LightKind::Directional) {
      batch.push(i, origin, arrival->to_light, arrival->distance_m, reflected);
    } else {
      batch.push(i, origin, Vec3(light.position - DVec3(origin)), 1.0F, reflected);
    }
  }
  batch.resolve(scene_.triangles(), Coherence::Coherent, radiance, work);
}

void Lighting::add_area(int k, std::span<const LitPoint> points, std::span<Rgb> radiance,
                        LightingWork& work) const {
  const lights::LightList& list = scene_.lights();
  const float share = 1.0F / static_cast<float>(config_.area_light_samples);
  ShadowBatch batch;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const LitPoint& point = points[i];
    const lights::AreaSample sample =
        list.sample_area(stratified(point, kAreaDimension, k, config_.area_light_samples));
    const lights::EmissiveTriangle& light = list.emissive()[sample.light];
    const Vec3 towards(sample.position - point.position);
    const float distance2 = glm::dot(towards, towards);
    const float facing = -glm::dot(light.normal, towards);  // cosine at the light times distance
    if (!(facing > 0.0F)) continue;
    const float distance = std::sqrt(distance2);
    const Rgb reflected = point.reflector.evaluate(towards / distance);
    if (is_black(reflected)) continue;
    const float geometry = facing / (distance * distance2 * sample.pdf_per_m2);
    const Rgb emission =
        list.emission(sample.light, sample.barycentric, scene_.surfaces(), scene_.materials());
    // The end, too, is moved off its surface, so that the light cannot shadow itself.
    const Vec3 origin = ray_origin(point);
    const Vec3 end = visibility::offset_ray_origin(Vec3(sample.position), light.normal);
    batch.push(i, origin, end - origin, 1.0F, share * geometry * reflected * emission);
  }
  batch.resolve(scene_.triangles(), Coherence::Coherent, radiance, work);
}

void Lighting::add_ambient(int k, std::span<const LitPoint> points, std::span<Rgb> radiance,
                           LightingWork& work) const {
  const scene::Settings& settings = scene_.scene().settings;
  const Rgb share = settings.ambient / static_cast<float>(config_.ambient_samples);
  ShadowBatch batch;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const shading::ShadingFrame& frame = points[i].reflector.frame();
    const Vec3 local = sampling::cosine_hemisphere(
        stratified(points[i], kAmbientDimension, k, config_.ambient_samples));
    Vec3 direction = sampling::frame_from_normal(frame.shading) * local;
    // What a bent shading normal sends below the surface is folded back up: an open point sees
    // exactly the whole environment.
    const float height = glm::dot(direction, frame.geometric);
    if (height < 0.0F) direction -= 2.0F * height * frame.geometric;
    batch.push(i, ray_origin(points[i]), direction, static_cast<float>(settings.ambient_distance_m),
               share * points[i].reflector.reflectance());
  }
  batch.resolve(scene_.triangles(), Coherence::Incoherent, radiance, work);
}

}  // namespace macula::kernels::ray
