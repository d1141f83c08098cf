#include "server/kernels/ray/lighting.h"

#include <algorithm>
#include <chrono>

#include "server/lights/cut_sampler.h"
#include "server/sampling/mappings.h"
#include "server/sampling/sobol.h"
#include "shared/base/check.h"

namespace macula::kernels::ray {
namespace {

using sampling::Vec3Batch;
using visibility::Coherence;

// Dimensions of a cell's random numbers; those below 2^31 place the primary samples.
constexpr std::uint32_t kAreaDimension = 0x8000'0000U;
constexpr std::uint32_t kAmbientDimension = 0x8000'0001U;
constexpr std::uint32_t kEnvironmentDimension = 0x8000'0002U;
constexpr std::uint32_t kStrategyDimension = 0x8000'0003U;
/// Of shadow rays that meet blended surfaces; one a term, with the number of the ray in the term.
enum class Term : std::uint32_t { Punctual = 0x8000'0011U, Area, Ambient, Environment };

constexpr float kIdle = -1.0F;  ///< tfar of a ray that is not traced

/// Rays to this many triangles still run towards about the same place.
constexpr std::size_t kMostOfOneLamp = 8;

/// One batch on its way through all terms. The loops over points are plain, for the compiler's
/// vectors; what it cannot see through stands in the rooms' *_simd.cpp.
class Pass {
 public:
  Pass(const SceneFrame& scene, const Config& config, const LitPoints& points, LightingWork& work)
      : scene_(scene), config_(config), points_(points), work_(work), n_(points.count) {}

  void run();
  void add_to(std::span<Rgb> radiance) const {
    for (std::size_t i = 0; i < n_; ++i) radiance[i] += sum_[i];
  }
  void write_sampled(std::span<Rgb> sampled) const {
    for (std::size_t i = 0; i < n_; ++i) sampled[i] = sum_[i] - exact_[i];
  }

 private:
  void add_punctual(const scene::Light& light, std::size_t index);
  void add_area();
  void add_cut();
  void add_ambient();
  void add_environment();
  void aim_at_environment(const sampling::Vec2Batch& strategy);
  void scramble(std::uint32_t dimension);
  void draw(int k, int count);
  void aim_along(float tfar);
  void aim_at(const Vec3& target);
  void aim_at_lights();
  void resolve(Coherence coherence, Term term, std::size_t round);
  void draw_blending(Term term, std::size_t round);

  const SceneFrame& scene_;
  const Config& config_;
  const LitPoints& points_;
  LightingWork& work_;
  const std::size_t n_;

  Vec3Batch sum_{};           ///< radiance of all terms so far
  Vec3Batch exact_{};         ///< of those that need no chance
  Vec3Batch contribution_{};  ///< what each ray of a term brings if nothing is in its way
  sampling::ScramblingBatch sequences_{};
  sampling::Vec2Batch u_{};
  lights::AreaArrivalBatch light_{};
  visibility::RayStream rays_;
  visibility::OcclusionStream hidden_;
};

/// Only what the plan holds; a light list without the step is empty.
void Pass::run() {
  if (config_.lights == LightChoice::None) return;
  const bool by_cut = config_.lights == LightChoice::ByCut;
  const auto lights = by_cut ? scene_.placed_lights().apart() : scene_.lights().punctual();
  for (std::size_t k = 0; k < lights.size(); ++k) add_punctual(lights[k], k);
  exact_ = sum_;
  if (by_cut && scene_.placed_lights().size() > 0) add_cut();
  if (!by_cut && !scene_.lights().emissive().empty()) add_area();
  if (config_.ambient_samples > 0 && scene_.plan().has(scene::Step::Ambient)) add_ambient();
  if (scene_.plan().has(scene::Step::Environment)) add_environment();
}

void Pass::add_punctual(const scene::Light& light, std::size_t index) {
  lights::arriving(light, points_.position, n_, light_.arrival);
  shading::reflect(points_.reflectors, light_.arrival.to_light, light_.arrival.irradiance, n_,
                   contribution_);
  if (light.kind == scene::LightKind::Directional) {
    aim_along(std::numeric_limits<float>::infinity());
  } else {
    aim_at(Vec3(light.position));
  }
  resolve(Coherence::Coherent, Term::Punctual, index);
}

void Pass::add_area() {
  scramble(kAreaDimension);
  const float share = 1.0F / static_cast<float>(config_.area_light_samples);
  const bool one_lamp = scene_.lights().emissive().size() <= kMostOfOneLamp;
  const Coherence coherence = one_lamp ? Coherence::Coherent : Coherence::Incoherent;
  for (int k = 0; k < config_.area_light_samples; ++k) {
    draw(k, config_.area_light_samples);
    scene_.lights().arriving_area(u_, points_.position, n_, scene_.surfaces(), scene_.materials(),
                                  light_);
    shading::reflect(points_.reflectors, light_.arrival.to_light, light_.arrival.irradiance, n_,
                     contribution_);
    for (std::size_t i = 0; i < n_; ++i) {
      contribution_.x[i] *= share, contribution_.y[i] *= share, contribution_.z[i] *= share;
    }
    aim_at_lights();
    resolve(coherence, Term::Area, static_cast<std::size_t>(k));
  }
}

/// One light of every node of each point's cut; rays of one round go to about the same places.
void Pass::add_cut() {
  const lights::PlacedLights& lights = scene_.placed_lights();
  const auto most = static_cast<std::size_t>(config_.area_light_samples);
  lights::CutSampler sampler(lights.tree(), most);
  sampler.cut(points_.position, points_.reflectors.shading, n_, points_.cut_nodes);
  lights::LightDraws draws{};
  scramble(kAreaDimension);
  for (std::size_t round = 0; round < sampler.rounds(); ++round) {
    draw(static_cast<int>(round), config_.area_light_samples);
    sampler.draw(round, points_.keys, points_.sample, draws);
    lights.arriving(draws, u_, points_.position, n_, scene_.lights(), scene_.surfaces(),
                    scene_.materials(), light_);
    shading::reflect(points_.reflectors, light_.arrival.to_light, light_.arrival.irradiance, n_,
                     contribution_);
    aim_at_lights();
    resolve(Coherence::Incoherent, Term::Area, round);
  }
}

void Pass::add_ambient() {
  scramble(kAmbientDimension);
  const scene::Settings& settings = scene_.scene().settings;
  const Rgb share = settings.ambient / static_cast<float>(config_.ambient_samples);
  const Vec3Batch& reflectance = points_.reflectors.reflectance;
  for (std::size_t i = 0; i < n_; ++i) {
    contribution_.x[i] = share.x * reflectance.x[i];
    contribution_.y[i] = share.y * reflectance.y[i];
    contribution_.z[i] = share.z * reflectance.z[i];
  }
  for (int k = 0; k < config_.ambient_samples; ++k) {
    draw(k, config_.ambient_samples);
    // What a bent shading normal sends below the surface is folded back up: an open point sees
    // exactly the whole environment.
    sampling::cosine_directions(u_, points_.reflectors.shading, points_.reflectors.geometric, n_,
                                light_.arrival.to_light);
    aim_along(static_cast<float>(settings.ambient_distance_m));
    resolve(Coherence::Incoherent, Term::Ambient, static_cast<std::size_t>(k));
  }
}

/// One sample of a mixture of two strategies, the environment's table and the surface's own
/// directions, over the density of the mixture: Veach's balance heuristic.
void Pass::add_environment() {
  const float share = 1.0F / static_cast<float>(config_.environment_samples);
  for (int k = 0; k < config_.environment_samples; ++k) {
    scramble(kStrategyDimension);
    draw(k, config_.environment_samples);
    const sampling::Vec2Batch strategy = u_;
    scramble(kEnvironmentDimension);
    draw(k, config_.environment_samples);
    aim_at_environment(strategy);
    shading::reflect(points_.reflectors, light_.arrival.to_light, light_.arrival.irradiance, n_,
                     contribution_);
    for (std::size_t i = 0; i < n_; ++i) {
      contribution_.x[i] *= share, contribution_.y[i] *= share, contribution_.z[i] *= share;
    }
    aim_along(std::numeric_limits<float>::infinity());
    resolve(Coherence::Incoherent, Term::Environment, static_cast<std::size_t>(k));
  }
}

void Pass::aim_at_environment(const sampling::Vec2Batch& strategy) {
  const lights::EnvironmentLight& environment = scene_.environment();
  const float table_share = environment.is_constant() ? 0.0F : 0.5F;
  for (std::size_t i = 0; i < n_; ++i) {
    const shading::Reflector& reflector = points_.whole[i];
    const bool by_table = strategy.x[i] < table_share;
    const Vec3 to_light = by_table ? environment.sample(u_[i]).to_light
                                   : reflector.sample_direction({strategy.y[i], u_.x[i], u_.y[i]});
    const float pdf =
        table_share * environment.pdf(to_light) + (1.0F - table_share) * reflector.pdf(to_light);
    light_.arrival.to_light.set(i, to_light);
    light_.arrival.irradiance.set(i, pdf > 0.0F ? environment.radiance(to_light) / pdf : Rgb{0.0F});
  }
}

void Pass::scramble(std::uint32_t dimension) {
  for (std::size_t i = 0; i < n_; ++i) {
    const std::uint32_t seed = sampling::scramble_seed(points_.keys[i], dimension);
    sequences_.set(i, sampling::Scrambling(seed));
  }
}

/// Sample k of `count` at this primary sample: a consecutive stretch of each cell's one sequence,
/// so that all of a cell's samples together are stratified too.
void Pass::draw(int k, int count) {
  const std::uint32_t index =
      points_.sample * static_cast<std::uint32_t>(count) + static_cast<std::uint32_t>(k);
  sampling::sobol_owen_2d(index, sequences_, n_, u_);
}

void Pass::aim_along(float tfar) {
  for (std::size_t i = 0; i < n_; ++i) {
    rays_.dx[i] = light_.arrival.to_light.x[i];
    rays_.dy[i] = light_.arrival.to_light.y[i];
    rays_.dz[i] = light_.arrival.to_light.z[i];
    rays_.tfar[i] = tfar;
  }
}

void Pass::aim_at(const Vec3& target) {
  for (std::size_t i = 0; i < n_; ++i) {
    rays_.dx[i] = target.x - points_.ray_origin.x[i];
    rays_.dy[i] = target.y - points_.ray_origin.y[i];
    rays_.dz[i] = target.z - points_.ray_origin.z[i];
    rays_.tfar[i] = 1.0F;
  }
}

/// The end, too, is moved off its surface, so that the light cannot shadow itself.
void Pass::aim_at_lights() {
  for (std::size_t i = 0; i < n_; ++i) {
    const Vec3 end = visibility::offset_ray_origin(light_.position[i], light_.normal[i], 0.0F,
                                                   light_.span.at[i]);
    rays_.dx[i] = end.x - points_.ray_origin.x[i];
    rays_.dy[i] = end.y - points_.ray_origin.y[i];
    rays_.dz[i] = end.z - points_.ray_origin.z[i];
    rays_.tfar[i] = 1.0F;
  }
}

/// Each ray meets blended surfaces by chances of its own, in mode Fast as in mode Exact: what they
/// let through is noise among noise.
void Pass::draw_blending(Term term, std::size_t round) {
  const std::uint64_t index = (std::uint64_t{points_.sample} << 32) | round;
  for (std::size_t i = 0; i < n_; ++i) {
    rays_.blend[i] = visibility::blend_by_chance(
        sampling::sample_bits(points_.keys[i], static_cast<std::uint32_t>(term), index));
  }
}

/// Traces the aimed rays that have something to bring, and sums what arrives.
void Pass::resolve(Coherence coherence, Term term, std::size_t round) {
  std::uint32_t traced = 0;
  const Vec3Batch& c = contribution_;
  for (std::size_t i = 0; i < n_; ++i) {
    const bool brings = !(c.x[i] == 0.0F) | !(c.y[i] == 0.0F) | !(c.z[i] == 0.0F);
    rays_.tfar[i] = brings ? rays_.tfar[i] : kIdle;
    traced += brings ? 1U : 0U;
    rays_.ox[i] = points_.ray_origin.x[i];
    rays_.oy[i] = points_.ray_origin.y[i];
    rays_.oz[i] = points_.ray_origin.z[i];
    rays_.tnear[i] = 0.0F;
  }
  if (traced == 0) return;
  rays_.count = static_cast<int>(n_);
  if (scene_.triangles().blends()) draw_blending(term, round);
  const auto begin = std::chrono::steady_clock::now();
  scene_.occluded(rays_, hidden_, coherence);
  work_.trace_ms += units::to_ms(std::chrono::steady_clock::now() - begin);
  work_.shadow_rays += traced;
  for (std::size_t i = 0; i < n_; ++i) {
    const bool arrives = hidden_.occluded[i] == 0;
    sum_.x[i] += arrives ? c.x[i] : 0.0F;
    sum_.y[i] += arrives ? c.y[i] : 0.0F;
    sum_.z[i] += arrives ? c.z[i] : 0.0F;
  }
}

}  // namespace

void LitPoints::push(const shading::Surface& surface, const shading::Reflector& reflector,
                     sampling::SampleKey key) {
  MACULA_DCHECK(count < sampling::kBatch);
  const Vec3 rounded(surface.position);
  position.set(count, rounded);
  ray_origin.set(count, visibility::offset_ray_origin(rounded, reflector.frame().geometric, 0.0F,
                                                      surface.span_m));
  reflectors.set(count, reflector);
  if (keeps_whole) whole.push_back(reflector);
  keys[count] = key;
  ++count;
}

void Lighting::add(const LitPoints& points, std::span<Rgb> radiance, LightingWork& work,
                   std::span<Rgb> sampled) const {
  MACULA_DCHECK(points.count == radiance.size());
  if (points.count == 0) return;
  Pass pass(scene_, config_, points, work);
  pass.run();
  pass.add_to(radiance);
  if (!sampled.empty()) pass.write_sampled(sampled);
}

}  // namespace macula::kernels::ray
