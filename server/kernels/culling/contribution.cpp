#include "server/kernels/culling/contribution.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "server/kernels/culling/local_openness.h"
#include "server/scheduling/run_shared.h"
#include "shared/image/color.h"

namespace macula::kernels::culling {
namespace {

using lights::VirtualPointLight;
using visibility::kStreamCapacity;

/// As many lights as one stream holds rays for.
class LightBatch {
 public:
  LightBatch(const SceneFrame& scene, std::span<const ShadingPoint> points, const Config& config,
             double least_m, std::uint64_t frame, const LampMaps* maps,
             std::span<const Openness> around_points)
      : scene_(scene),
        points_(points),
        rays_a_light_(rays_of(config, points.size())),
        squares_(config.mean == PointMean::OfSquares),
        openness_of_point_(config.openness_of_point),
        maps_(maps),
        around_points_(around_points),
        least_m_(least_m),
        frame_(frame) {}

  static int rays_of(const Config& config, std::size_t points) {
    if (config.hiding != Hiding::Rays) return 0;
    return std::min(config.visibility_rays, static_cast<int>(points));
  }
  static int lights_of(const Config& config) {
    return kStreamCapacity / std::max(config.visibility_rays, 1);
  }

  /// Lights [first, first + lights.size()) of the whole list; returns the rays traced.
  std::uint64_t run(std::size_t first, std::span<const VirtualPointLight> lights,
                    std::span<float> unhidden, std::span<float> visible) {
    for (std::size_t i = 0; i < lights.size(); ++i) {
      unhidden[i] = mean_over_points(lights[i]);
      for (int k = 0; k < rays_a_light_; ++k) ask(lights[i], point_of(first + i, k));
    }
    if (rays_a_light_ == 0) return 0;
    scene_.occluded(rays_, hidden_, visibility::Coherence::Incoherent);
    for (std::size_t i = 0; i < lights.size(); ++i)
      visible[i] = share_that_arrives(i * static_cast<std::size_t>(rays_a_light_), unhidden[i]);
    return static_cast<std::uint64_t>(rays_.count);
  }

 private:
  float arriving(const VirtualPointLight& light, const ShadingPoint& point) const {
    const auto arrival = lights::arriving(light, DVec3(point.position), least_m_);
    if (!arrival) return 0.0F;
    const float cosine = std::max(glm::dot(point.normal, arrival->to_light), 0.0F);
    return cosine * point.albedo * image::luminance(arrival->irradiance);
  }
  float counted(const VirtualPointLight& light, const ShadingPoint& point) const {
    const float brings = arriving(light, point);
    return squares_ ? brings * brings : brings;
  }
  float mean_over_points(const VirtualPointLight& light) const {
    float sum = 0.0F;
    if (maps_ == nullptr) {
      for (const ShadingPoint& point : points_) sum += counted(light, point);
    } else {
      const Openness around = maps_->around(Vec3(light.position), light.normal);
      for (std::size_t i = 0; i < points_.size(); ++i)
        sum += openness(around, light, i) * counted(light, points_[i]);
    }
    return sum / static_cast<float>(points_.size());
  }
  float openness(const Openness& around_light, const VirtualPointLight& light,
                 std::size_t point) const {
    const Vec3 d = glm::normalize(points_[point].position - Vec3(light.position));
    return std::lerp(around_light.towards(d), around_points_[point].towards(-d),
                     openness_of_point_);
  }
  /// Strides through the points: neighbours in the list and a light's own rays go far apart.
  const ShadingPoint& point_of(std::size_t light, int k) const {
    constexpr std::uint64_t kStride = 0x9E37'79B9U;
    const std::uint64_t turn = (light + frame_) * static_cast<std::uint64_t>(rays_a_light_);
    return points_[(turn + static_cast<std::uint64_t>(k)) * kStride % points_.size()];
  }
  void ask(const VirtualPointLight& light, const ShadingPoint& point) {
    const Vec3 origin =
        visibility::offset_ray_origin(point.position, point.normal, point.distance_m);
    const Vec3 end =
        visibility::offset_ray_origin(Vec3(light.position), light.normal, 0.0F, light.span_m);
    const float brings = counted(light, point);
    brings_[static_cast<std::size_t>(rays_.count)] = brings;
    rays_.push(origin, end - origin, 0.0F, brings > 0.0F ? 1.0F : -1.0F);
  }
  /// As if one more ray had found an average point open: few rays that all end early do not mean
  /// that nothing arrives anywhere.
  float share_that_arrives(std::size_t first, float mean) const {
    float all = mean, arrives = mean;
    for (std::size_t k = first; k < first + static_cast<std::size_t>(rays_a_light_); ++k) {
      all += brings_[k];
      arrives += hidden_.occluded[k] != 0 ? 0.0F : brings_[k];
    }
    return all > 0.0F ? arrives / all : 1.0F;
  }

  const SceneFrame& scene_;
  std::span<const ShadingPoint> points_;
  int rays_a_light_;
  bool squares_;
  float openness_of_point_;
  const LampMaps* maps_;  ///< none: everything is open
  std::span<const Openness> around_points_;
  double least_m_;
  std::uint64_t frame_;
  visibility::RayStream rays_;
  visibility::OcclusionStream hidden_;
  std::array<float, kStreamCapacity> brings_;
};

/// Diagonal of the box about all lights; more than nothing.
double extent(std::span<const VirtualPointLight> lights) {
  scene::Bounds box;
  for (const VirtualPointLight& light : lights) box.include(light.position);
  return std::max(glm::length(box.size()), 1e-6);  // meters: one light is nowhere wide
}

}  // namespace

Contributions contributions(const SceneFrame& scene, std::span<const VirtualPointLight> lights,
                            std::span<const ShadingPoint> points, const Config& config,
                            double least_m, std::uint64_t frame,
                            scheduling::TileScheduler& scheduler) {
  Contributions made;
  made.unhidden.assign(lights.size(), 0.0F);
  made.visible.assign(lights.size(), 1.0F);
  if (points.empty()) return made;
  std::optional<LampMaps> maps;
  std::vector<Openness> around_points;
  if (config.hiding == Hiding::LampMaps) {
    maps.emplace(scene, static_cast<float>(extent(lights)), scheduler);
    for (const ShadingPoint& point : points)
      around_points.push_back(maps->around(point.position, point.normal));
    made.rays = maps->rays();
  }
  const auto step = static_cast<std::size_t>(LightBatch::lights_of(config));
  std::vector<std::uint64_t> rays((lights.size() + step - 1) / step);
  const auto part_of = [&](auto& all, std::size_t batch) {
    return std::span(all).subspan(batch * step, std::min(step, all.size() - batch * step));
  };
  const auto outcome = scheduling::run_shared(
      scheduler, rays.size(), scheduling::Audience::EveryRank, scheduling::nowhere(rays.size()),
      [&](std::size_t batch) {
        rays[batch] = LightBatch(scene, points, config, least_m, frame, maps ? &*maps : nullptr,
                                 around_points)
                          .run(batch * step, part_of(lights, batch), part_of(made.unhidden, batch),
                               part_of(made.visible, batch));
      },
      [&](std::size_t batch, scheduling::Parcel& parcel) {
        parcel.value(rays[batch]);
        parcel.values(part_of(made.unhidden, batch));
        parcel.values(part_of(made.visible, batch));
      });
  for (const std::uint64_t traced : rays) made.rays += traced;
  made.stopped = outcome == scheduling::Outcome::Stopped;
  return made;
}

}  // namespace macula::kernels::culling
