#include "server/kernels/ray/lighting.h"

#include <algorithm>
#include <chrono>

#include "server/kernels/ray/bounce.h"
#include "server/kernels/ray/surface_stage.h"
#include "server/kernels/ray/virtual_draws.h"
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
constexpr std::uint32_t kNearDimension = 0x8000'0006U, kNearLobeDimension = 0x8000'0007U;
/// Of shadow rays that meet blended surfaces; one a term, with the number of the ray in the term.
enum class Term : std::uint32_t { Punctual = 0x8000'0011U, Area, Ambient, Environment, Virtual };

/// Rays to this many triangles still run towards about the same place.
constexpr std::size_t kMostOfOneLamp = 8;

/// Rays of a term that are aimed before any of them is traced.
constexpr std::size_t kMostRounds = 16;

/// One round of a term: for every point a ray and what it brings if nothing is in its way.
struct Round {
  Vec3Batch direction, contribution;
  sampling::FloatBatch tfar;
  visibility::BlendRule blend[sampling::kBatch];
  bool arrives[sampling::kBatch];
};

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
  void add_lamps();
  void add_punctual(const scene::Light& light, std::size_t index);
  void add_area();
  void add_cut();
  void add_ambient();
  void add_environment();
  void add_virtual();
  void add_near_light();
  void let_through();
  void resolve_virtual(const VirtualDraws& draws, bool alike);
  void aim_at_environment(const sampling::Vec2Batch& strategy);
  void scramble(std::uint32_t dimension);
  void draw(int k, int count);
  Round& round() { return rounds_[kept_]; }
  void aim_along(float tfar);
  void aim_at(const Vec3& target);
  void aim_at_lights();
  void share_contribution(float share);
  void keep(Term term, std::size_t round);
  void resolve(Coherence coherence);
  void ask(std::size_t round, std::size_t point, Coherence coherence);
  void sum_up();
  void trace_stream(Coherence coherence);

  const SceneFrame& scene_;
  const Config& config_;
  const LitPoints& points_;
  LightingWork& work_;
  const std::size_t n_;
  const bool blends_ = scene_.triangles().blends();

  Vec3Batch sum_{};    ///< radiance of all terms so far
  Vec3Batch exact_{};  ///< of those that need no chance
  sampling::ScramblingBatch sequences_{};
  sampling::Vec2Batch u_{};
  lights::AreaArrivalBatch light_{};
  Round rounds_[kMostRounds];
  std::size_t kept_ = 0;  ///< rounds that wait to be traced
  visibility::RayStream rays_;
  visibility::OcclusionStream hidden_;
  bool* arrives_[visibility::kStreamCapacity];  ///< where the answer to each ray belongs
};

/// Only what the plan holds; a light list without the step is empty.
void Pass::run() {
  if (config_.lights != LightChoice::None) add_lamps();
  if (config_.virtual_lights.any()) add_virtual();
  if (config_.virtual_lights.any() && config_.virtual_lights.near_light == NearLight::Bounced)
    add_near_light();
}

void Pass::add_lamps() {
  const bool by_cut = config_.lights == LightChoice::ByCut;
  const auto lights = by_cut ? scene_.placed_lights().apart() : scene_.lights().punctual();
  for (std::size_t k = 0; k < lights.size(); ++k) add_punctual(lights[k], k);
  exact_ = sum_;
  if (by_cut && scene_.placed_lights().size() > 0) add_cut();
  if (!by_cut && !scene_.lights().emissive().empty()) add_area();
  if (config_.ambient_samples > 0 && scene_.plan().has(scene::Step::Ambient)) add_ambient();
  if (config_.environment_samples > 0 && scene_.plan().has(scene::Step::Environment))
    add_environment();
}

void Pass::add_punctual(const scene::Light& light, std::size_t index) {
  lights::arriving(light, points_.position, n_, light_.arrival);
  shading::reflect(points_.reflectors, light_.arrival.to_light, light_.arrival.irradiance, n_,
                   round().contribution);
  if (light.kind == scene::LightKind::Directional) {
    aim_along(std::numeric_limits<float>::infinity());
  } else {
    aim_at(Vec3(light.position));
  }
  keep(Term::Punctual, index);
  resolve(Coherence::Coherent);
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
                     round().contribution);
    share_contribution(share);
    aim_at_lights();
    keep(Term::Area, static_cast<std::size_t>(k));
    if (kept_ == kMostRounds) resolve(coherence);
  }
  resolve(coherence);
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
                     this->round().contribution);
    aim_at_lights();
    keep(Term::Area, round);
    resolve(Coherence::Incoherent);
  }
}

void Pass::add_ambient() {
  scramble(kAmbientDimension);
  const scene::Settings& settings = scene_.scene().settings;
  const Rgb share = settings.ambient / static_cast<float>(config_.ambient_samples);
  const Vec3Batch& reflectance = points_.reflectors.reflectance;
  for (int k = 0; k < config_.ambient_samples; ++k) {
    draw(k, config_.ambient_samples);
    Vec3Batch& contribution = round().contribution;
    for (std::size_t i = 0; i < n_; ++i) {
      contribution.x[i] = share.x * reflectance.x[i];
      contribution.y[i] = share.y * reflectance.y[i];
      contribution.z[i] = share.z * reflectance.z[i];
    }
    // What a bent shading normal sends below the surface is folded back up: an open point sees
    // exactly the whole environment.
    sampling::cosine_directions(u_, points_.reflectors.shading, points_.reflectors.geometric, n_,
                                light_.arrival.to_light);
    aim_along(static_cast<float>(settings.ambient_distance_m));
    keep(Term::Ambient, static_cast<std::size_t>(k));
    if (kept_ == kMostRounds) resolve(Coherence::Incoherent);
  }
  resolve(Coherence::Incoherent);
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
                     round().contribution);
    share_contribution(share);
    aim_along(std::numeric_limits<float>::infinity());
    keep(Term::Environment, static_cast<std::size_t>(k));
    if (kept_ == kMostRounds) resolve(Coherence::Incoherent);
  }
  resolve(Coherence::Incoherent);
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

/// Points of one class follow each other: they ask the same lights, so that their rays meet.
void Pass::add_virtual() {
  const VirtualLightShare& share = config_.virtual_lights;
  const VirtualDraws draws(share, points_);
  const bool alike = share.asked == 0;
  lights::LightDraws drawn{};
  for (std::size_t k = 0; k < draws.rounds(); ++k) {
    draws.draw(k, drawn);
    share.lights->arriving(drawn, points_.position, n_, light_);
    shading::reflect(points_.reflectors, light_.arrival.to_light, light_.arrival.irradiance, n_,
                     round().contribution);
    aim_at_lights();
    keep(Term::Virtual, k);
    if (kept_ == kMostRounds) resolve_virtual(draws, alike);
  }
  resolve_virtual(draws, alike);
}

void Pass::resolve_virtual(const VirtualDraws& draws, bool alike) {
  if (config_.virtual_lights.shadows == VirtualShadows::None) return let_through();
  if (!alike) return resolve(Coherence::Incoherent);
  rays_.clear();
  for (std::size_t k = 0; k < kept_; ++k)
    for (const std::uint16_t i : draws.by_class()) ask(k, i, Coherence::Coherent);
  trace_stream(Coherence::Coherent);
  sum_up();
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

void Pass::share_contribution(float share) {
  Vec3Batch& c = round().contribution;
  for (std::size_t i = 0; i < n_; ++i) c.x[i] *= share, c.y[i] *= share, c.z[i] *= share;
}

void Pass::aim_along(float tfar) {
  Round& ray = round();
  ray.direction = light_.arrival.to_light;
  for (std::size_t i = 0; i < n_; ++i) ray.tfar.at[i] = tfar;
}

void Pass::aim_at(const Vec3& target) {
  Round& ray = round();
  const Vec3Batch& origin = points_.ray_origin;
  for (std::size_t i = 0; i < n_; ++i) {
    ray.direction.x[i] = target.x - origin.x[i];
    ray.direction.y[i] = target.y - origin.y[i];
    ray.direction.z[i] = target.z - origin.z[i];
    ray.tfar.at[i] = 1.0F;
  }
}

/// The end, too, is moved off its surface, so that the light cannot shadow itself.
void Pass::aim_at_lights() {
  Round& ray = round();
  for (std::size_t i = 0; i < n_; ++i) {
    const Vec3 end = visibility::offset_ray_origin(light_.position[i], light_.normal[i], 0.0F,
                                                   light_.span.at[i]);
    ray.direction.set(i, end - points_.ray_origin[i]);
    ray.tfar.at[i] = 1.0F;
  }
}

/// Puts the aimed round away until resolve(). Each ray meets blended surfaces by chances of its
/// own, in mode Fast as in mode Exact: what they let through is noise among noise.
void Pass::keep(Term term, std::size_t index) {
  Round& ray = round();
  ++kept_;
  if (!blends_) return;
  const std::uint64_t number = (std::uint64_t{points_.sample} << 32) | index;
  for (std::size_t i = 0; i < n_; ++i) {
    ray.blend[i] = visibility::blend_by_chance(
        sampling::sample_bits(points_.keys[i], static_cast<std::uint32_t>(term), number));
  }
}

/// Traces the kept rays that have something to bring, point by point: those of one point, and of
/// its neighbours, are the most alike.
void Pass::resolve(Coherence coherence) {
  rays_.clear();
  for (std::size_t i = 0; i < n_; ++i)
    for (std::size_t k = 0; k < kept_; ++k) ask(k, i, coherence);
  trace_stream(coherence);
  sum_up();
}

/// Capping distances at l takes the share 1 - d^2 / l^2 from light of d < l. All that arrives from
/// there is met by rays of length l, drawn as the surface reflects.
void Pass::add_near_light() {
  const float least_m = config_.virtual_lights.lights->least_m();
  if (!(least_m > 0.0F)) return;
  std::array<Rgb, sampling::kBatch> weight{}, back;
  std::array<sampling::SampleKey, sampling::kBatch> keys;
  scramble(kNearDimension);
  draw(0, 1);
  const sampling::Vec2Batch u = u_;
  scramble(kNearLobeDimension);
  draw(0, 1);
  rays_.clear();
  for (std::size_t i = 0; i < n_; ++i) {
    const auto scattered = points_.whole[i].sample({u_.x[i], u.x[i], u.y[i]});
    if (scattered) weight[i] = scattered->weight;
    rays_.push(points_.ray_origin[i], scattered ? scattered->to_light : Vec3{0, 0, 1}, 0.0F,
               scattered ? least_m : -1.0F);
    keys[i].value = math::hash_combine(points_.keys[i].value, kNearDimension);
  }
  visibility::HitStream hits;
  bounce(rays_, {keys.data(), n_}, scene_, config_, hits, {back.data(), n_}, work_);
  for (std::size_t i = 0; i < n_; ++i) {
    if (!hits.hit(static_cast<int>(i))) continue;
    const float near = hits.t[i] / least_m;
    sum_.set(i, sum_[i] + std::max(1.0F - near * near, 0.0F) * weight[i] * back[i]);
  }
}

/// Nothing hides anything.
void Pass::let_through() {
  for (std::size_t k = 0; k < kept_; ++k) std::fill_n(rounds_[k].arrives, n_, true);
  sum_up();
}

void Pass::ask(std::size_t round, std::size_t point, Coherence coherence) {
  Round& ray = rounds_[round];
  const Vec3Batch& c = ray.contribution;
  ray.arrives[point] = false;
  const bool brings = !(c.x[point] == 0.0F) | !(c.y[point] == 0.0F) | !(c.z[point] == 0.0F);
  if (!brings) return;
  if (rays_.full()) trace_stream(coherence);
  const int place =
      rays_.push(points_.ray_origin[point], ray.direction[point], 0.0F, ray.tfar.at[point]);
  if (blends_) rays_.blend[place] = ray.blend[point];
  arrives_[place] = &ray.arrives[point];
}

/// Adds what arrives, round by round, and keeps none.
void Pass::sum_up() {
  for (std::size_t k = 0; k < kept_; ++k) {
    const Round& ray = rounds_[k];
    const Vec3Batch& c = ray.contribution;
    for (std::size_t i = 0; i < n_; ++i) {
      sum_.x[i] += ray.arrives[i] ? c.x[i] : 0.0F;
      sum_.y[i] += ray.arrives[i] ? c.y[i] : 0.0F;
      sum_.z[i] += ray.arrives[i] ? c.z[i] : 0.0F;
    }
  }
  kept_ = 0;
}

void Pass::trace_stream(Coherence coherence) {
  if (rays_.count == 0) return;
  const auto begin = std::chrono::steady_clock::now();
  scene_.occluded(rays_, hidden_, coherence);
  work_.trace_ms += units::to_ms(std::chrono::steady_clock::now() - begin);
  work_.shadow_rays += static_cast<std::uint64_t>(rays_.count);
  for (int i = 0; i < rays_.count; ++i) *arrives_[i] = hidden_.occluded[i] == 0;
  rays_.clear();
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

void LitPoints::append(const SurfaceGroup& group) {
  const std::size_t n = group.points.count;
  MACULA_DCHECK(count + n <= sampling::kBatch);
  position.copy(count, group.surfaces.position, n);
  ray_origin.copy(count, group.ray_origin, n);
  reflectors.copy(count, group.reflectors, n);
  for (std::size_t k = 0; keeps_whole && k < n; ++k) whole.push_back(group.reflector(k));
  count += n;
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
