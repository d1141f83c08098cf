#include "server/kernels/culling/camera_lights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "server/kernels/ray/bounce.h"
#include "server/sampling/frame.h"
#include "server/sampling/mappings.h"
#include "server/sampling/sobol.h"
#include "server/scheduling/run_shared.h"

namespace macula::kernels::culling {
namespace {

using lights::VirtualPointLight;
using sampling::SampleKey;
using visibility::kStreamCapacity;

constexpr std::uint64_t kCameraKey = 0xC0117'0003ULL;
constexpr float kPi = std::numbers::pi_v<float>;

/// As many lights as one stream has rays.
class CameraBatch {
 public:
  CameraBatch(const SceneFrame& scene, std::span<const ShadingPoint> points, int count,
              const Config& config)
      : scene_(scene), points_(points), count_(count), config_(config) {}

  std::uint64_t run(int first, std::span<VirtualPointLight> out) {
    std::array<SampleKey, kStreamCapacity> keys;
    std::array<Rgb, kStreamCapacity> radiance;
    for (std::size_t i = 0; i < out.size(); ++i) {
      const auto index = static_cast<std::uint32_t>(first) + static_cast<std::uint32_t>(i);
      keys[i] = SampleKey(index, 0, kCameraKey);
      send(index);
    }
    const auto n = static_cast<std::size_t>(rays_.count);
    ray::bounce(rays_, {keys.data(), n}, scene_, config_.ray, hits_, {radiance.data(), n}, work_);
    for (std::size_t i = 0; i < n; ++i)
      if (radiance[i] != Rgb{0.0F}) out[i] = light_at(static_cast<int>(i), radiance[i]);
    return work_.shadow_rays + asked_ + n;
  }

 private:
  void send(std::uint32_t index) {
    const ShadingPoint& from = points_[index % points_.size()];
    const Vec2 u = sampling::sobol_owen_2d(
        index / static_cast<std::uint32_t>(points_.size()),
        sampling::scramble_seed(SampleKey(0, 0, kCameraKey),
                                index % static_cast<std::uint32_t>(points_.size())));
    const Vec3 direction =
        sampling::frame_from_normal(from.normal) * sampling::cosine_hemisphere(u);
    rays_.push(visibility::offset_ray_origin(from.position, from.normal, from.distance_m),
               direction, 0.0F, std::numeric_limits<float>::infinity());
  }

  VirtualPointLight light_at(int i, const Rgb& radiance) {
    const shading::Surface surface =
        scene_.surface(hits_.at(i), DVec3(rays_.origin(i) + hits_.t[i] * rays_.direction(i)));
    VirtualPointLight light;
    light.position = surface.position;
    light.normal = surface.geometric_normal;
    if (glm::dot(light.normal, rays_.direction(i)) > 0.0F) light.normal = -light.normal;
    light.span_m = surface.span_m;
    const float density = rays_per_m2(light);
    if (!(density > 0.0F)) return light;
    const float lights_per_m2 = density * static_cast<float>(count_);
    light.flux = kPi * radiance / lights_per_m2;
    light.footprint_m = 1.0F / std::sqrt(kPi * lights_per_m2);
    return light;
  }

  /// Of all points together, one ray sent.
  float rays_per_m2(const VirtualPointLight& light) {
    const Vec3 place(light.position);
    const Vec3 end = visibility::offset_ray_origin(place, light.normal, 0.0F, light.span_m);
    float sum = 0.0F;
    for (std::size_t first = 0; first < points_.size(); first += kStreamCapacity) {
      const std::size_t n = std::min<std::size_t>(kStreamCapacity, points_.size() - first);
      std::array<float, kStreamCapacity> share;
      asking_.clear();
      for (std::size_t k = 0; k < n; ++k) {
        const ShadingPoint& point = points_[first + k];
        const Vec3 towards = place - point.position;
        const float distance2 = glm::dot(towards, towards);
        const float cosines = std::max(glm::dot(point.normal, towards), 0.0F) *
                              std::max(-glm::dot(light.normal, towards), 0.0F);
        share[k] = cosines > 0.0F ? cosines / (kPi * distance2 * distance2) : 0.0F;
        const Vec3 origin =
            visibility::offset_ray_origin(point.position, point.normal, point.distance_m);
        asking_.push(origin, end - origin, 0.0F, share[k] > 0.0F ? 1.0F : -1.0F);
      }
      scene_.occluded(asking_, hidden_, visibility::Coherence::Incoherent);
      for (std::size_t k = 0; k < n; ++k) sum += hidden_.occluded[k] == 0 ? share[k] : 0.0F;
      asked_ += n;
    }
    return sum / static_cast<float>(points_.size());
  }

  const SceneFrame& scene_;
  std::span<const ShadingPoint> points_;
  int count_;
  const Config& config_;
  visibility::RayStream rays_, asking_;
  visibility::HitStream hits_;
  visibility::OcclusionStream hidden_;
  ray::LightingWork work_;
  std::uint64_t asked_ = 0;
};

}  // namespace

CameraLights camera_lights(const SceneFrame& scene, std::span<const ShadingPoint> points, int count,
                           const Config& config, scheduling::TileScheduler& scheduler) {
  CameraLights made;
  if (points.empty()) return made;
  made.lights.resize(static_cast<std::size_t>(count));
  constexpr std::size_t kStep = kStreamCapacity;
  std::vector<std::uint64_t> rays((made.lights.size() + kStep - 1) / kStep);
  const auto lights_of = [&](std::size_t batch) {
    const std::size_t first = batch * kStep;
    return std::span(made.lights).subspan(first, std::min(kStep, made.lights.size() - first));
  };
  const auto outcome = scheduling::run_shared(
      scheduler, rays.size(), scheduling::Audience::EveryRank, scheduling::nowhere(rays.size()),
      [&](std::size_t batch) {
        rays[batch] = CameraBatch(scene, points, count, config)
                          .run(static_cast<int>(batch * kStep), lights_of(batch));
      },
      [&](std::size_t batch, scheduling::Parcel& parcel) {
        parcel.value(rays[batch]);
        parcel.values(lights_of(batch));
      });
  made.stopped = outcome == scheduling::Outcome::Stopped;
  for (const std::uint64_t traced : rays) made.rays += traced;
  std::erase_if(made.lights,
                [](const VirtualPointLight& light) { return light.flux == Rgb{0.0F}; });
  return made;
}

}  // namespace macula::kernels::culling
