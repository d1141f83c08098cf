// Where a ray that leaves a surface starts: far enough out that rounding cannot put the surface in
// its way, near enough that no visible gap opens. World space, meters. Source: the error-bounded
// offset of Pharr, Jakob, Humphreys, "Physically Based Rendering" (4th ed. 2023), section 6.8.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "shared/math/vec.h"

namespace macula::visibility {

/// Units in the last place of the span that an offset covers: of rays from squares about the
/// world's origin none meets its square from 1 on (tests hold it); transforms and thin triangles
/// take their share.
inline constexpr float kSpanUlps = 4.0F;
/// And of the point's largest coordinate: 3 for the interpolation of the point, 1 for the addition
/// of the offset, the rest for the transforms of instances and the intersector's own rounding.
inline constexpr float kPointUlps = 16.0F;

/// `normal`: unit geometric normal on the side the ray leaves to. `travelled_m`: length of the ray
/// that found `point` when the point was computed as origin + t direction; 0 when it was
/// interpolated from the triangle's vertices, whose error does not grow with distance. `span_m`:
/// the triangle's longest edge at its first vertex, or what else the intersector subtracts from
/// what near the point: the offset must cover the rounding of such differences also where the
/// point's own coordinates vanish.
inline Vec3 offset_ray_origin(const Vec3& point, const Vec3& normal, float travelled_m = 0.0F,
                              float span_m = 0.0F) {
  const float largest =
      std::max({std::abs(point.x), std::abs(point.y), std::abs(point.z), travelled_m});
  const float offset =
      std::numeric_limits<float>::epsilon() *
      std::max({kPointUlps * largest, kSpanUlps * span_m, std::numeric_limits<float>::min()});
  return point + offset * normal;
}

/// The span whose offset is `gap_m`, for surfaces that are known to such a distance only.
inline float span_of_gap(float gap_m) {
  return gap_m / (kSpanUlps * std::numeric_limits<float>::epsilon());
}

}  // namespace macula::visibility
