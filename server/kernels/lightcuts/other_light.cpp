#include "server/kernels/lightcuts/other_light.h"

#include <limits>

#include "server/sampling/mappings.h"
#include "server/sampling/sobol.h"

namespace macula::kernels::lightcuts {
namespace {

// Kernel `ray`'s dimensions of a cell's random numbers.
constexpr std::uint32_t kAmbientDimension = 0x8000'0001U;
constexpr std::uint32_t kEnvironmentDimension = 0x8000'0002U;
constexpr std::uint32_t kStrategyDimension = 0x8000'0003U;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

class Surroundings {
 public:
  Surroundings(const SceneFrame& scene, const ray::LitPoints& points, ray::LightingWork& work,
               std::span<Rgb> slots)
      : scene_(scene), points_(points), n_(points.count), rays_(scene, work), slots_(slots) {}

  void add_apart() {
    const auto lights = scene_.placed_lights().apart();
    for (std::uint32_t k = 0; k < lights.size(); ++k) {
      lights::arriving(lights[k], points_.position, n_, arrival_);
      reflect(1.0F);
      const bool somewhere = lights[k].kind != scene::LightKind::Directional;
      for (std::size_t i = 0; i < n_; ++i) {
        const Vec3 origin = points_.ray_origin[i];
        const Vec3 towards = somewhere ? Vec3(lights[k].position) - origin : arrival_.to_light[i];
        send(i, {origin, towards, somewhere ? 1.0F : kInfinity}, Term::Punctual, k);
      }
      rays_.flush(slots_);
    }
  }

  void add_ambient(int count) {
    const scene::Settings& settings = scene_.scene().settings;
    const Rgb share = settings.ambient / static_cast<float>(count);
    for (int k = 0; k < count; ++k) {
      draw(kAmbientDimension, k, count, u_);
      sampling::cosine_directions(u_, points_.reflectors.shading, points_.reflectors.geometric, n_,
                                  arrival_.to_light);
      for (std::size_t i = 0; i < n_; ++i) {
        reflected_.set(i, share * points_.reflectors.reflectance[i]);
        send(i,
             {points_.ray_origin[i], arrival_.to_light[i],
              static_cast<float>(settings.ambient_distance_m)},
             Term::Ambient, static_cast<std::uint32_t>(k));
      }
      rays_.flush(slots_);
    }
  }

  /// One sample of the environment's table or of the surface's own directions, over the density of
  /// the mixture (balance heuristic).
  void add_environment(int count) {
    for (int k = 0; k < count; ++k) {
      draw(kStrategyDimension, k, count, strategy_);
      draw(kEnvironmentDimension, k, count, u_);
      for (std::size_t i = 0; i < n_; ++i) aim_at_environment(i);
      reflect(1.0F / static_cast<float>(count));
      for (std::size_t i = 0; i < n_; ++i) {
        send(i, {points_.ray_origin[i], arrival_.to_light[i], kInfinity}, Term::Environment,
             static_cast<std::uint32_t>(k));
      }
      rays_.flush(slots_);
    }
  }

 private:
  void draw(std::uint32_t dimension, int k, int count, sampling::Vec2Batch& u) {
    for (std::size_t i = 0; i < n_; ++i) {
      const Vec2 at = sampling::sobol_owen_2d(
          points_.sample * static_cast<std::uint32_t>(count) + static_cast<std::uint32_t>(k),
          sampling::scramble_seed(points_.keys[i], dimension));
      u.x[i] = at.x, u.y[i] = at.y;
    }
  }
  void aim_at_environment(std::size_t i) {
    const lights::EnvironmentLight& environment = scene_.environment();
    const float table_share = environment.is_constant() ? 0.0F : 0.5F;
    const shading::Reflector& reflector = points_.whole[i];
    const bool by_table = strategy_.x[i] < table_share;
    const Vec3 to_light = by_table ? environment.sample(u_[i]).to_light
                                   : reflector.sample_direction({strategy_.y[i], u_.x[i], u_.y[i]});
    const float pdf =
        table_share * environment.pdf(to_light) + (1.0F - table_share) * reflector.pdf(to_light);
    arrival_.to_light.set(i, to_light);
    arrival_.irradiance.set(i, pdf > 0.0F ? environment.radiance(to_light) / pdf : Rgb{0.0F});
  }
  void reflect(float share) {
    shading::reflect(points_.reflectors, arrival_.to_light, arrival_.irradiance, n_, reflected_);
    for (std::size_t i = 0; i < n_; ++i) reflected_.set(i, share * reflected_[i]);
  }
  void send(std::size_t i, ShadowRay ray, Term term, std::uint32_t round) {
    ray.blend = blend_of(scene_, points_, i, term, round);
    rays_.push(ray, {reflected_[i], static_cast<std::uint32_t>(i)}, slots_);
  }

  const SceneFrame& scene_;
  const ray::LitPoints& points_;
  std::size_t n_;
  ShadowRays rays_;
  std::span<Rgb> slots_;
  lights::ArrivalBatch arrival_{};
  sampling::Vec2Batch u_{}, strategy_{};
  sampling::Vec3Batch reflected_{};
};

}  // namespace

void add_lights_apart(const SceneFrame& scene, const ray::LitPoints& points,
                      ray::LightingWork& work, std::span<Rgb> slots) {
  if (scene.placed_lights().apart().empty()) return;
  Surroundings(scene, points, work, slots).add_apart();
}

void add_surroundings(const SceneFrame& scene, const ray::Config& config,
                      const ray::LitPoints& points, ray::LightingWork& work, std::span<Rgb> slots) {
  const bool ambient = config.ambient_samples > 0 && scene.plan().has(scene::Step::Ambient);
  const bool environment = scene.plan().has(scene::Step::Environment);
  if (!ambient && !environment) return;
  Surroundings all(scene, points, work, slots);
  if (ambient) all.add_ambient(config.ambient_samples);
  if (environment) all.add_environment(config.environment_samples);
}

}  // namespace macula::kernels::lightcuts
