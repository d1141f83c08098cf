// LightStream: lights asked by single points, gathered into full batches: what each would send is
// evaluated in vectors, and a shadow ray is traced for what would arrive. Cuts of different sizes
// leave no lane idle. World, meters; one thread at a time; large, make one a tile.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/kernels/lightcuts/config.h"
#include "server/kernels/ray/lighting.h"
#include "server/kernels/scene_frame.h"

namespace macula::kernels::lightcuts {

/// One light asked by one point.
struct Ask {
  std::uint32_t light = 0;           ///< index into PlacedLights
  float inverse_probability = 0.0F;  ///< > 0
  Vec2 u{0.0F};                      ///< where on a triangle
};
/// What it would send to the eye by way of the point if nothing were in between.
struct Answer {
  Rgb reflected{0.0F};  ///< already over the probability
  Vec3 end{0.0F};       ///< of the shadow ray, off the light's surface
};

/// Asks up to a batch at a time.
class LightQuestions {
 public:
  /// Gloss::Yes: lights that rays of glossy points meet do without these points' lobes, or without
  /// the part that the rays bring (share_of_rays).
  explicit LightQuestions(const SceneFrame& scene, Gloss gloss = Gloss::No,
                          float lamp_area_m2 = 0.0F)
      : scene_(scene), gloss_(gloss), lamp_area_m2_(lamp_area_m2) {}

  std::size_t size() const { return count_; }
  bool full() const { return count_ == sampling::kBatch; }
  void push(const ray::LitPoints& points, std::size_t point, const Ask& ask);
  /// answers.size() >= size(); empties the batch.
  void answer(std::span<Answer> answers);

 private:
  float share_of_lobe(std::size_t i) const;

  const SceneFrame& scene_;
  Gloss gloss_;
  float lamp_area_m2_;
  std::size_t count_ = 0;
  lights::LightDraws draws_{};
  sampling::Vec2Batch u_{};
  sampling::Vec3Batch position_{}, reflected_{};
  shading::ReflectorBatch reflectors_{};
  lights::AreaArrivalBatch arrivals_{};
};

/// From `origin` to origin + far x direction.
struct ShadowRay {
  Vec3 origin{0.0F}, direction{0.0F};
  float far = 1.0F;
  visibility::BlendRule blend = visibility::blend_from(0.5F);
};
/// Where a shadow ray's light goes if it arrives.
struct Delivery {
  Rgb value{0.0F};
  std::uint32_t slot = 0;
};

/// Shadow rays on their way. Slots are the caller's; what arrives is added in the order of pushes.
class ShadowRays {
 public:
  ShadowRays(const SceneFrame& scene, ray::LightingWork& work) : scene_(scene), work_(work) {}

  /// Traces when full. Rays that bring nothing are not traced.
  void push(const ShadowRay& ray, const Delivery& delivery, std::span<Rgb> slots);
  void flush(std::span<Rgb> slots);

 private:
  const SceneFrame& scene_;
  ray::LightingWork& work_;
  visibility::RayStream rays_;
  visibility::OcclusionStream hidden_;
  std::array<Delivery, visibility::kStreamCapacity> deliveries_;
};

/// Kinds of shadow rays, for their chances to meet blended surfaces.
enum class Term : std::uint32_t { Punctual, Area, Ambient, Environment };
/// Of the `round`-th shadow ray of a term; kernel `ray`'s for the same point.
visibility::BlendRule blend_of(const SceneFrame& scene, const ray::LitPoints& points,
                               std::size_t point, Term term, std::uint32_t round);
/// Place on a triangle for the `round`-th light that a point asks of `rounds`; kernel `ray`'s.
Vec2 place_on_light(const ray::LitPoints& points, std::size_t point, std::uint32_t round,
                    std::uint32_t rounds);

}  // namespace macula::kernels::lightcuts
