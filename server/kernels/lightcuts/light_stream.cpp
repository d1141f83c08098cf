#include "server/kernels/lightcuts/light_stream.h"

#include <chrono>

#include "server/kernels/lightcuts/lobe.h"
#include "server/sampling/sobol.h"
#include "server/visibility/ray_offset.h"
#include "shared/base/check.h"

namespace macula::kernels::lightcuts {
namespace {

// Kernel `ray`'s dimensions of a cell's random numbers: cuts of equal sizes give equal pictures.
constexpr std::uint32_t kAreaDimension = 0x8000'0000U;
constexpr std::uint32_t kFirstBlending = 0x8000'0011U;

}  // namespace

void LightQuestions::push(const ray::LitPoints& points, std::size_t point, const Ask& ask) {
  MACULA_DCHECK(!full() && point < points.count);
  position_.set(count_, points.position[point]);
  reflectors_.take(count_, points.reflectors, point);
  draws_.light.at[count_] = ask.light;
  draws_.inverse_probability.at[count_] = ask.inverse_probability;
  u_.x[count_] = ask.u.x, u_.y[count_] = ask.u.y;
  ++count_;
}

void LightQuestions::answer(std::span<Answer> answers) {
  MACULA_DCHECK(answers.size() >= count_);
  if (count_ == 0) return;
  scene_.placed_lights().arriving(draws_, u_, position_, count_, scene_.lights(), scene_.surfaces(),
                                  scene_.materials(), arrivals_);
  shading::reflect(reflectors_, arrivals_.arrival.to_light, arrivals_.arrival.irradiance, count_,
                   reflected_);
  for (std::size_t i = 0; i < count_; ++i) {
    if (const float lobe = share_of_lobe(i); lobe < 1.0F) {
      const Rgb diffuse = reflect_diffusely(reflectors_, i, arrivals_.arrival.to_light[i],
                                            arrivals_.arrival.irradiance[i]);
      reflected_.set(i, diffuse + lobe * (reflected_[i] - diffuse));
    }
    answers[i].reflected = reflected_[i];
    answers[i].end = visibility::offset_ray_origin(arrivals_.position[i], arrivals_.normal[i], 0.0F,
                                                   arrivals_.span.at[i]);
  }
  count_ = 0;
}

/// Virtual lights stand for what glossy points see, whose rays also meet emissive triangles.
float LightQuestions::share_of_lobe(std::size_t i) const {
  if (gloss_ == Gloss::No || !is_glossy(reflectors_.alpha.at[i])) return 1.0F;
  const lights::PlacedLights& lights = scene_.placed_lights();
  if (draws_.light.at[i] >= lights.first_virtual()) return 0.0F;
  if (arrivals_.normal[i] == Vec3{0.0F}) return 1.0F;  // a lamp without extent
  const Vec3 between = arrivals_.position[i] - position_[i];
  return 1.0F - share_of_rays(reflectors_, i, arrivals_.arrival.to_light[i],
                              glm::dot(between, between), lamp_area_m2_);
}

void ShadowRays::push(const ShadowRay& ray, const Delivery& delivery, std::span<Rgb> slots) {
  if (delivery.value == Rgb{0.0F}) return;
  const int i = rays_.push(ray.origin, ray.direction, 0.0F, ray.far, ray.blend);
  deliveries_[static_cast<std::size_t>(i)] = delivery;
  if (rays_.full()) flush(slots);
}

void ShadowRays::flush(std::span<Rgb> slots) {
  if (rays_.count == 0) return;
  const auto begin = std::chrono::steady_clock::now();
  scene_.occluded(rays_, hidden_, visibility::Coherence::Incoherent);
  work_.trace_ms += units::to_ms(std::chrono::steady_clock::now() - begin);
  work_.shadow_rays += static_cast<std::uint64_t>(rays_.count);
  for (std::size_t i = 0; i < static_cast<std::size_t>(rays_.count); ++i) {
    if (hidden_.occluded[i] == 0) slots[deliveries_[i].slot] += deliveries_[i].value;
  }
  rays_.clear();
}

visibility::BlendRule blend_of(const SceneFrame& scene, const ray::LitPoints& points,
                               std::size_t point, Term term, std::uint32_t round) {
  if (!scene.triangles().blends()) return visibility::blend_from(0.5F);
  const std::uint64_t index = (std::uint64_t{points.sample} << 32) | round;
  return visibility::blend_by_chance(sampling::sample_bits(
      points.keys[point], kFirstBlending + static_cast<std::uint32_t>(term), index));
}

Vec2 place_on_light(const ray::LitPoints& points, std::size_t point, std::uint32_t round,
                    std::uint32_t rounds) {
  return sampling::sobol_owen_2d(points.sample * rounds + round,
                                 sampling::scramble_seed(points.keys[point], kAreaDimension));
}

}  // namespace macula::kernels::lightcuts
