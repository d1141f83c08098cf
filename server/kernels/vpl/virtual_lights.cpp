#include "server/kernels/vpl/virtual_lights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "server/lights/light_rays.h"
#include "server/sampling/sample.h"
#include "server/sampling/sobol.h"
#include "server/scheduling/run_shared.h"
#include "shared/base/check.h"
#include "shared/image/color.h"

namespace macula::kernels::vpl {
namespace {

using lights::LightRay;
using lights::VirtualPointLight;
using scheduling::TileScheduler;
using visibility::kStreamCapacity;

/// Pairs of dimensions of one light's sequence of rays; the last decides on blended surfaces.
enum Dimension : std::uint32_t { kPlace = 0, kDirection = 2, kBlend = 4 };

/// What one lamp, or all emissive triangles, sends out.
struct Source {
  const scene::Light* punctual = nullptr;  ///< null: the emissive triangles
  std::size_t first = 0, count = 0;        ///< its rays
  sampling::SampleKey key;
};

std::size_t square(int side) {
  MACULA_CHECK(side >= 0, "a light cannot be asked for fewer rays than none");
  return static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
}

class Sources {
 public:
  Sources(const SceneFrame& scene, const Config& config) {
    for (const scene::Light& light : scene.lights().punctual()) {
      add(&light, square(config.side), config.seed);
    }
    if (!scene.lights().emissive().empty()) {
      add(nullptr, square(config.emissive_side), config.seed);
    }
  }
  std::size_t rays() const { return rays_; }
  bool any_directional() const {
    return std::ranges::any_of(sources_, [](const Source& source) {
      return source.punctual && source.punctual->kind == scene::LightKind::Directional;
    });
  }
  /// Whose ray `slot` is.
  const Source& of(std::size_t slot) const {
    return *std::prev(std::ranges::upper_bound(sources_, slot, {}, &Source::first));
  }

 private:
  void add(const scene::Light* light, std::size_t count, std::uint64_t seed) {
    if (count == 0) return;
    sources_.push_back({light, rays_, count, sampling::SampleKey(seed, 0, sources_.size())});
    rays_ += count;
  }
  std::vector<Source> sources_;
  std::size_t rays_ = 0;
};

bool shines(const Rgb& flux) {
  return math::is_finite(flux) && flux.x + flux.y + flux.z > 0.0F;
}

/// Share of the light from `to_light` that leaves diffusely. By reciprocity: what the diffuse part
/// reflects towards there of a uniform environment.
Rgb diffuse_reflectance(const shading::Bsdf& bsdf, const shading::ShadingFrame& frame) {
  if (!bsdf.glossy()) return bsdf.albedo;
  shading::Bsdf lobe = bsdf;
  lobe.albedo = Rgb{0.0F};
  return glm::max(
      shading::Reflector(bsdf, frame).reflectance() - shading::Reflector(lobe, frame).reflectance(),
      Rgb{0.0F});
}

/// One stream of consecutive slots.
class StreamRun {
 public:
  StreamRun(const SceneFrame& scene, const Config& config, const Sources& sources,
            const scene::Bounds& lit)
      : scene_(scene), config_(config), sources_(sources), lit_(lit) {}

  /// Fills slots [first, first + out.size()); a light without flux where there is none.
  void run(std::size_t first, std::span<VirtualPointLight> out) {
    for (std::size_t i = 0; i < out.size(); ++i) send(first + i);
    scene_.intersect(rays_, hits_, visibility::Coherence::Incoherent);
    for (std::size_t i = 0; i < out.size(); ++i) {
      if (hits_.hit(static_cast<int>(i)))
        out[i] = reflect(static_cast<int>(i), sources_.of(first + i));
    }
  }

 private:
  void send(std::size_t slot) {
    const Source& source = sources_.of(slot);
    const auto index = static_cast<std::uint32_t>(slot - source.first);
    const LightRay ray = draw(source, index);
    flux_[rays_.count] = ray.flux / static_cast<float>(source.count);
    spread_[rays_.count] = spread_of(ray, source);
    const Vec3 origin = ray.surface_normal == Vec3{0.0F}
                            ? Vec3(ray.origin)
                            : visibility::offset_ray_origin(Vec3(ray.origin), ray.surface_normal,
                                                            0.0F, ray.surface_span_m);
    // A ray without flux is idle: tfar < tnear.
    const float far = shines(ray.flux) ? std::numeric_limits<float>::infinity() : -1.0F;
    rays_.push(origin, ray.direction, 0.0F, far,
               visibility::blend_by_chance(sampling::sample_bits(source.key, kBlend, index)));
  }

  LightRay draw(const Source& source, std::uint32_t index) const {
    const auto point = [&](Dimension dimension) {
      return sampling::sobol_owen_2d(index, sampling::scramble_seed(source.key, dimension));
    };
    const Vec2 direction = glm::fract(point(kDirection) + config_.shift);
    if (source.punctual) return lights::ray_from(*source.punctual, lit_, direction);
    return lights::ray_from_area(scene_.lights(), point(kPlace), direction, scene_.surfaces(),
                                 scene_.materials());
  }

  /// What the ray stands for: steradians of a point or a spot (where that shines most), square
  /// meters across directional light.
  static float spread_of(const LightRay& ray, const Source& source) {
    if (!source.punctual || !shines(ray.flux)) return std::numeric_limits<float>::infinity();
    return image::luminance(ray.flux) / image::luminance(source.punctual->intensity) /
           static_cast<float>(source.count);
  }
  /// Radius of the disc that the spread covers where the ray lands.
  static float footprint_m(float spread, const Source& source, const DVec3& at, float cosine) {
    const bool parallel =
        !source.punctual || source.punctual->kind == scene::LightKind::Directional;
    const double distance = parallel ? 1.0 : glm::length(at - source.punctual->position);
    return static_cast<float>(distance *
                              std::sqrt(static_cast<double>(spread / cosine) / std::numbers::pi));
  }

  VirtualPointLight reflect(int i, const Source& source) const {
    const shading::Surface surface =
        scene_.surface(hits_.at(i), DVec3(rays_.origin(i) + hits_.t[i] * rays_.direction(i)));
    const Vec3 to_light = -rays_.direction(i);
    const auto towards = [](const Vec3& normal, const Vec3& side) {
      return glm::dot(normal, side) < 0.0F ? -normal : normal;
    };
    const Vec3 geometric = towards(surface.geometric_normal, to_light);
    const Vec3 shading = towards(surface.shading_normal, geometric);
    const float cos_geometric = glm::dot(geometric, to_light);
    const float cos_shading = glm::dot(shading, to_light);
    if (!(cos_geometric > 0.0F && cos_shading > 0.0F)) return {};
    const Rgb share = diffuse_reflectance(scene_.materials().bsdf(surface, {}, config_.model),
                                          {geometric, shading, to_light});
    return {surface.position, geometric, surface.span_m,
            flux_[i] * share * (cos_shading / cos_geometric),
            footprint_m(spread_[i], source, surface.position, cos_geometric)};
  }

  const SceneFrame& scene_;
  const Config& config_;
  const Sources& sources_;
  const scene::Bounds& lit_;
  visibility::RayStream rays_;
  visibility::HitStream hits_;
  Rgb flux_[kStreamCapacity];
  float spread_[kStreamCapacity];
};

}  // namespace

Config shared_out(const SceneFrame& scene, std::size_t rays) {
  const lights::LightList& lamps = scene.lights();
  const std::size_t maps = lamps.punctual().size() + (lamps.emissive().empty() ? 0 : 1);
  const double share =
      static_cast<double>(rays) / static_cast<double>(std::max<std::size_t>(maps, 1));
  const int side = static_cast<int>(std::sqrt(share));
  return {side, side};
}

VirtualLights make_virtual_lights(const SceneFrame& scene, const Config& config,
                                  TileScheduler& scheduler) {
  const Sources sources(scene, config);
  const scene::Bounds lit =
      sources.any_directional() ? scene.scene().bounds(scene.time()) : scene::Bounds{};
  std::vector<VirtualPointLight> slots(sources.rays());
  const auto step = static_cast<std::size_t>(kStreamCapacity);
  const std::size_t streams = (slots.size() + step - 1) / step;
  const auto slots_of = [&](std::size_t stream) {
    return std::span(slots).subspan(stream * step, std::min(step, slots.size() - stream * step));
  };
  const auto outcome = scheduling::run_shared(
      scheduler, streams, scheduling::Audience::EveryRank, scheduling::nowhere(streams),
      [&](std::size_t stream) {
        StreamRun(scene, config, sources, lit).run(stream * step, slots_of(stream));
      },
      [&](std::size_t stream, scheduling::Parcel& parcel) { parcel.values(slots_of(stream)); });
  if (outcome == scheduling::Outcome::Stopped) return {{}, 0, true};
  std::erase_if(slots, [](const VirtualPointLight& light) { return !shines(light.flux); });
  return {std::move(slots), sources.rays(), false};
}

}  // namespace macula::kernels::vpl
