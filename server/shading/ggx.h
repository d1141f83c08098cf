// The GGX microfacet lobe in its local frame, z along the normal: distribution, Smith's
// height-correlated masking and sampling of visible normals. Directions are unit and point away
// from the surface. Sources: Walter et al. (2007); Heitz (2014), "Understanding the
// Masking-Shadowing Function", eq. 99; Heitz (2018), "Sampling the GGX Distribution of Visible
// Normals".
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shared/math/vec.h"

namespace macula::shading {

inline constexpr float kPi = std::numbers::pi_v<float>;
/// Below this width a float can no longer represent the lobe's peak against its tail.
inline constexpr float kLeastAlpha = 1e-3F;

/// D in 1/sr, for the cosine between half vector and normal.
inline float ggx_distribution(float cos_half, float alpha) {
  if (cos_half <= 0.0F) return 0.0F;
  const float a2 = alpha * alpha, c2 = cos_half * cos_half;
  // 1 - c2 is left as a product: near the peak the naive c2 (a2 - 1) + 1 cancels.
  const float width = c2 * a2 + (1.0F - cos_half) * (1.0F + cos_half);
  return a2 / (kPi * width * width);
}
/// Smith's Lambda for a direction with cosine `c` > 0.
inline float ggx_lambda(float c, float alpha) {
  const float c2 = std::min(c * c, 1.0F);
  return 0.5F * (std::sqrt(1.0F + alpha * alpha * (1.0F - c2) / c2) - 1.0F);
}
/// G2 / (4 cos_v cos_l), the factor that turns D F into a reflectance, both cosines > 0.
inline float ggx_visibility(float cos_v, float cos_l, float alpha) {
  const float a2 = alpha * alpha;
  const float v = cos_l * std::sqrt(cos_v * cos_v * (1.0F - a2) + a2);
  const float l = cos_v * std::sqrt(cos_l * cos_l * (1.0F - a2) + a2);
  return 0.5F / (v + l);
}
/// Schlick's weight of f90.
inline float schlick_weight(float cos_view_half) {
  const float m = std::clamp(1.0F - cos_view_half, 0.0F, 1.0F);
  return m * m * m * m * m;
}
/// A visible half vector seen from `view` (view.z > 0) for u in [0, 1)^2.
inline Vec3 ggx_sample_half(const Vec3& view, float alpha, const Vec2& u) {
  const Vec3 stretched = glm::normalize(Vec3(alpha * view.x, alpha * view.y, view.z));
  const float horizontal = stretched.x * stretched.x + stretched.y * stretched.y;
  const Vec3 t1 = horizontal > 0.0F ? Vec3(-stretched.y, stretched.x, 0.0F) / std::sqrt(horizontal)
                                    : Vec3(1.0F, 0.0F, 0.0F);
  const Vec3 t2 = glm::cross(stretched, t1);
  const float radius = std::sqrt(u.x), phi = 2.0F * kPi * u.y;
  const float p1 = radius * std::cos(phi);
  const float blend = 0.5F * (1.0F + stretched.z);
  const float p2 =
      (1.0F - blend) * std::sqrt(std::max(0.0F, 1.0F - p1 * p1)) + blend * radius * std::sin(phi);
  const Vec3 half =
      p1 * t1 + p2 * t2 + std::sqrt(std::max(0.0F, 1.0F - p1 * p1 - p2 * p2)) * stretched;
  return glm::normalize(Vec3(alpha * half.x, alpha * half.y, std::max(1e-7F, half.z)));
}
/// Density of the reflected direction in 1/sr, for view.z > 0; it may lie below the surface.
inline float ggx_reflection_pdf(float cos_v, float cos_half, float alpha) {
  return ggx_distribution(cos_half, alpha) / (4.0F * cos_v * (1.0F + ggx_lambda(cos_v, alpha)));
}

}  // namespace macula::shading
