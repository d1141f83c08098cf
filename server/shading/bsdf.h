// The one BSDF of all kernels: Lambert under a GGX lobe (Smith height-correlated, Schlick Fresnel),
// glTF metallic-roughness with KHR_materials_specular. Energy: what the lobe reflects, E(view), is
// taken from the diffuse part on the way in and out (Kelemen and Szirmay-Kalos 2001),
//   f = D G F / (4 cos_v cos_l) + albedo / pi (1 - E(v)) (1 - E(l)) / (1 - E_mean),
// so the sum is reciprocal and never reflects more than it receives; without a lobe it is exactly
// albedo / pi. Where a paper was printed with it, Phong's lobe instead (phong.h): f0 times the lobe
// beside (1 - f0) albedo / pi, without a Fresnel term. Reflection only, on both sides of a surface.
// Directions: unit, world, away from it.
#pragma once

#include <cstdint>
#include <optional>

#include "shared/image/color.h"
#include "shared/math/vec.h"

namespace macula::shading {

enum class LobeModel : std::uint8_t { Ggx, Phong };

/// A material at one point; view-independent.
struct Bsdf {
  Rgb albedo{0.0F};    ///< diffuse reflectance before the lobe takes its share, [0, 1]
  Rgb f0{0.0F};        ///< lobe's reflectance at normal incidence, [0, 1]
  float f90 = 0.0F;    ///< at grazing incidence, [0, 1]; 0 with Phong's lobe
  float alpha = 1.0F;  ///< GGX width, roughness squared, [kLeastAlpha, 1]; Phong's about as wide
  LobeModel lobe = LobeModel::Ggx;

  bool glossy() const { return f90 > 0.0F || f0.x > 0.0F || f0.y > 0.0F || f0.z > 0.0F; }
};

/// The normals at a point. Rule for shading normals: `geometric` is turned towards the eye and
/// alone decides which side light arrives on (no leaking through the surface); `shading` is turned
/// to the same side and, where the eye lies below its horizon, bent towards the eye until it lies
/// just above (no black rims). Cosines and lobes use `shading`.
struct ShadingFrame {
  Vec3 geometric{0.0F, 0.0F, 1.0F};
  Vec3 shading{0.0F, 0.0F, 1.0F};
  Vec3 to_eye{0.0F, 0.0F, 1.0F};
};
/// Normals of either orientation, unit; `to_eye` unit.
ShadingFrame make_shading_frame(const Vec3& geometric, const Vec3& shading, const Vec3& to_eye);

struct BsdfSample {
  Vec3 to_light{0.0F};
  Rgb weight{0.0F};  ///< f cos / pdf
  float pdf = 0.0F;  ///< 1/sr
};

/// A BSDF seen from one direction, ready for many lights.
class Reflector {
 public:
  Reflector() = default;
  Reflector(const Bsdf& bsdf, const ShadingFrame& frame);

  /// f(to_eye, to_light) times the cosine at the shading normal; 0 for light from below either
  /// normal.
  Rgb evaluate(const Vec3& to_light) const;
  /// Share of a uniform environment that is reflected to the eye: at most 1 a channel. Of Phong's
  /// lobe as much as head-on, which is what its ambient term counts.
  const Rgb& reflectance() const { return reflectance_; }
  /// A direction with the density of pdf(); u in [0, 1)^3: the first chooses the lobe. It may lie
  /// below the surface, where nothing is reflected.
  Vec3 sample_direction(const Vec3& u) const;
  /// The same with its weight; nullopt where the direction reflects nothing.
  std::optional<BsdfSample> sample(const Vec3& u) const;
  /// Density of sample() over the whole sphere, 1/sr; 1 in total, also counting rejected
  /// directions.
  float pdf(const Vec3& to_light) const;
  const ShadingFrame& frame() const { return frame_; }

 private:
  friend struct ReflectorBatch;
  Rgb evaluate_lobe(const Vec3& to_light, float cos_l) const;
  Rgb evaluate_phong(const Vec3& to_light, float cos_l) const;
  Vec3 sample_lobe(const Vec2& u) const;
  float lobe_pdf(const Vec3& to_light) const;
  void share_between(const Rgb& lobe, const Rgb& passed);

  Bsdf bsdf_;
  ShadingFrame frame_;
  bool glossy_ = false;
  float cos_v_ = 1.0F;
  Rgb diffuse_{0.0F};  ///< everything of the diffuse term that does not depend on the light
  Rgb reflectance_{0.0F};
  float lobe_share_ = 0.0F;  ///< probability of sampling the lobe
};

}  // namespace macula::shading
