// Phong's lobe around the mirrored direction, scaled so that it reflects all it receives where it
// is seen head-on and never more: (n + 2) / (2 pi) cos^n of the angle to the mirrored light
// (Lafortune and Willems 1994, "Using the modified Phong reflectance model for physically based
// rendering", section 2). Reciprocal. Directions are unit and point away from the surface.
#pragma once

#include <cmath>
#include <numbers>

#include "shared/math/vec.h"

namespace macula::shading {

/// The exponent of a lobe about as wide as the GGX lobe of width alpha > 0 (Walter et al. 2007,
/// section 5.3, read backwards); at least 0.
inline float phong_exponent(float alpha) {
  return 2.0F / (alpha * alpha) - 2.0F;
}
/// cos^n of the angle between two unit directions, 0 beyond a right angle. By their difference: a
/// float's cosine near 1 would lose lobes sharper than n = 1e5 in its rounding.
inline float phong_power(const Vec3& a, const Vec3& b, float exponent) {
  const Vec3 difference = a - b;
  const float below_one = 0.5F * glm::dot(difference, difference);
  return below_one < 1.0F ? std::exp(exponent * std::log1p(-below_one)) : 0.0F;
}
/// The direction to the eye mirrored in the normal.
inline Vec3 mirrored(const Vec3& to_eye, const Vec3& normal) {
  return 2.0F * glm::dot(normal, to_eye) * normal - to_eye;
}
/// Value of the lobe in 1/sr, for a power of phong_power().
inline float phong_lobe(float power, float exponent) {
  return (exponent + 2.0F) * 0.5F * std::numbers::inv_pi_v<float> * power;
}
/// A direction about z with the density of phong_pdf(), u in [0, 1)^2.
inline Vec3 phong_sample(float exponent, const Vec2& u) {
  const float cosine = std::pow(1.0F - u.x, 1.0F / (exponent + 1.0F));
  const float sine = std::sqrt(std::max(0.0F, (1.0F - cosine) * (1.0F + cosine)));
  const float phi = 2.0F * std::numbers::pi_v<float> * u.y;
  return {sine * std::cos(phi), sine * std::sin(phi), cosine};
}
/// In 1/sr; over the sphere, 1 in total.
inline float phong_pdf(float power, float exponent) {
  return (exponent + 1.0F) * 0.5F * std::numbers::inv_pi_v<float> * power;
}

}  // namespace macula::shading
