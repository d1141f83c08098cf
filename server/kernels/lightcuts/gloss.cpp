#include "server/kernels/lightcuts/gloss.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <memory>

#include "server/kernels/lightcuts/lobe.h"
#include "server/kernels/ray/shading_point.h"
#include "server/kernels/ray/surface_stage.h"
#include "server/sampling/sobol.h"

namespace macula::kernels::lightcuts {
namespace {

/// Of a cell's random numbers: directions; and from here on the points that its rays meet.
constexpr std::uint32_t kLobeDimension = 0xC000'0000U;
constexpr std::uint32_t kMetDimension = 0xC000'0001U;
/// Shadow rays of these rays that meet blended surfaces have the points' keys, rays their own.
constexpr std::uint32_t kBlendDimension = 0xC100'0000U;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// One light, one ambient and one environment ray where a ray arrives: more rays, which average
/// over directions too, buy more.
ray::Config lit_sparsely(const ray::Config& config) {
  ray::Config sparse = config;
  sparse.lights = ray::LightChoice::ByCut;
  sparse.virtual_lights = {};
  sparse.area_light_samples = sparse.environment_samples = 1;
  sparse.ambient_samples = std::min(config.ambient_samples, 1);
  return sparse;
}

/// The rays of one tile, a batch after the other.
class GlossRays {
 public:
  GlossRays(const SceneFrame& scene, const ray::Config& config, const SurfaceTile& tile,
            const CutPlan& plan, ray::LightingWork& work, std::span<Rgb> slots)
      : scene_(scene),
        config_(lit_sparsely(config)),
        points_(tile.points),
        lamp_area_m2_(plan.lamp_area_m2),
        work_(work),
        slots_(slots) {
    met_.keeps_whole = scene.plan().has(scene::Step::Environment);
  }

  void send(std::uint32_t point, int count) {
    const std::uint32_t seed = sampling::scramble_seed(points_.keys[point], kLobeDimension);
    const std::uint32_t first = points_.sample * static_cast<std::uint32_t>(count);
    for (int k = 0; k < count; ++k) {
      const std::uint32_t round = first + static_cast<std::uint32_t>(k);
      const auto sample =
          sample_lobe(points_.reflectors, point, sampling::sobol_owen_2d(round, seed));
      if (!sample) continue;
      push(point, round, sample->to_light, sample->weight / static_cast<float>(count));
      if (rays_.full()) follow();
    }
  }
  /// Traces what was sent, and lights what it meets.
  void follow() {
    if (rays_.count == 0) return;
    const auto begin = std::chrono::steady_clock::now();
    scene_.intersect(rays_, hits_, visibility::Coherence::Incoherent);
    work_.trace_ms += units::to_ms(std::chrono::steady_clock::now() - begin);
    work_.shadow_rays += static_cast<std::uint64_t>(rays_.count);
    meet();
    ray::Lighting(scene_, config_).add(met_, {lit_.data(), met_.count}, work_);
    deliver();
    rays_.clear();
  }

 private:
  void push(std::uint32_t point, std::uint32_t round, const Vec3& to_light, const Rgb& weight) {
    const sampling::SampleKey key = points_.keys[point];
    const auto rule =
        scene_.triangles().blends()
            ? visibility::blend_by_chance(sampling::sample_bits(key, kBlendDimension, round))
            : visibility::blend_from(0.5F);
    const int i = rays_.push(points_.ray_origin[point], to_light, 0.0F, kInfinity, rule);
    Sent& sent = sent_[static_cast<std::size_t>(i)];
    sent.point = point, sent.weight = weight;
    sent.key.value = math::hash_combine(math::hash_combine(key.value, kMetDimension), round);
  }

  void meet() {
    met_.clear();
    if (ray::shades_in_vectors(scene_)) return meet_groups();
    for (int i = 0; i < rays_.count; ++i)
      if (hits_.hit(i)) meet_point(i);
  }
  void meet_groups() {
    const ray::HitGroups groups(hits_, static_cast<std::size_t>(rays_.count));
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const std::span<const std::uint16_t> rays = groups.rays(g);
      group_.collect(rays_, hits_, rays);
      std::fill_n(group_.sample_area.at, rays.size(), 0.0F);
      group_.shade(scene_, config_);
      for (std::size_t k = 0; k < rays.size(); ++k) {
        own(rays[k], met_.count + k);
        lit_[met_.count + k] = share_of(rays[k]) * group_.emission(k, scene_);
      }
      met_.append(group_);
    }
  }
  void meet_point(int i) {
    const Vec3 ray = rays_.direction(i);
    ray::ShadingRequest request;
    request.surface = scene_.surface(hits_.at(i), DVec3(rays_.origin(i) + hits_.t[i] * ray));
    request.to_eye = -ray;
    own(static_cast<std::uint16_t>(i), met_.count);
    const ray::ShadedPoint shaded = ray::shade_point(request, scene_, config_);
    lit_[met_.count] = share_of(static_cast<std::uint16_t>(i)) * shaded.emission;
    met_.push(request.surface, shaded.reflector, sent_[static_cast<std::size_t>(i)].key);
  }
  /// Of what shines where the ray arrives.
  float share_of(std::uint16_t ray) const {
    const float t = hits_.t[ray];
    return share_of_rays(points_.reflectors, sent_[ray].point, rays_.direction(ray), t * t,
                         lamp_area_m2_);
  }
  void own(std::uint16_t ray, std::size_t place) {
    owner_[place] = ray, lit_[place] = Rgb{0.0F};
    met_.keys[place] = sent_[ray].key;
  }

  /// In the order of rays, whatever they met.
  void deliver() {
    std::fill_n(back_.begin(), rays_.count, Rgb{0.0F});
    for (std::size_t k = 0; k < met_.count; ++k)
      if (math::is_finite(lit_[k])) back_[owner_[k]] = lit_[k];
    for (std::size_t i = 0; i < static_cast<std::size_t>(rays_.count); ++i)
      slots_[sent_[i].point] += sent_[i].weight * back_[i];
  }

  struct Sent {
    std::uint32_t point = 0;
    Rgb weight{0.0F};
    sampling::SampleKey key;  ///< of the point it meets
  };

  const SceneFrame& scene_;
  const ray::Config config_;
  const ray::LitPoints& points_;
  float lamp_area_m2_;
  ray::LightingWork& work_;
  std::span<Rgb> slots_;
  visibility::RayStream rays_;
  visibility::HitStream hits_;
  ray::LitPoints met_{};
  ray::SurfaceGroup group_{};
  std::array<Sent, sampling::kBatch> sent_;
  std::array<std::uint16_t, sampling::kBatch> owner_;
  std::array<Rgb, sampling::kBatch> lit_, back_;
};

}  // namespace

bool has_gloss(const SceneFrame& scene, const ray::Config& config) {
  const shading::MaterialTable& materials = scene.materials();
  for (scene::Index i = 0; i < materials.size(); ++i)
    if (is_glossy(materials.lobe_width(i, config.materials))) return true;
  return false;
}

float lamp_area(const SceneFrame& scene) {
  const auto lamps = scene.lights().emissive();
  double sum_m2 = 0.0;
  for (const lights::EmissiveTriangle& lamp : lamps) sum_m2 += static_cast<double>(lamp.area_m2);
  return lamps.empty() ? 0.0F : static_cast<float>(sum_m2 / static_cast<double>(lamps.size()));
}

int gloss_rays(const Config& config, int nodes) {
  return config.sizes == CutSizes::Uniform ? nodes : config.gloss_rays.of(nodes);
}

namespace {

/// body(point, rays) for every glossy point.
template <class Body>
void for_each_glossy(const Config& config, const SurfaceTile& tile, const CutPlan& plan,
                     const Body& body) {
  for (std::uint32_t i = 0; i < tile.points.count; ++i) {
    if (!is_glossy(tile.points.reflectors.alpha.at[i])) continue;
    const image::Pixel cell = tile.pixel(i);
    body(i, gloss_rays(config, plan.nodes(cell.x, cell.y)));
  }
}

}  // namespace

float gloss_work(const Config& config, const SurfaceTile& tile, const CutPlan& plan) {
  int rays = 0;
  for_each_glossy(config, tile, plan, [&](std::uint32_t, int count) { rays += count; });
  return static_cast<float>(rays);
}

void add_gloss(const SceneFrame& scene, const Config& config, const SurfaceTile& tile,
               const CutPlan& plan, ray::LightingWork& work, std::span<Rgb> slots) {
  std::unique_ptr<GlossRays> rays;  // most tiles show nothing glossy
  for_each_glossy(config, tile, plan, [&](std::uint32_t point, int count) {
    if (!rays) rays = std::make_unique<GlossRays>(scene, config.ray, tile, plan, work, slots);
    rays->send(point, count);
  });
  if (rays) rays->follow();
}

}  // namespace macula::kernels::lightcuts
