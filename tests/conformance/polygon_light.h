// Irradiance that a polygon of radiance 1 gives, in closed form (Lambert 1760): half the sum over
// its edges of the angle an edge subtends, times the cosine between the surface's normal and the
// normal of the plane through edge and point. Double precision, one's own arithmetic throughout.
#pragma once

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <vector>

#include "shared/math/vec.h"

namespace macula::test {

/// For a polygon that lies wholly above the plane of (`point`, unit `normal`); either winding.
inline double polygon_irradiance(const DVec3& point, const DVec3& normal,
                                 const std::vector<DVec3>& corners) {
  double sum = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const DVec3 a = glm::normalize(corners[i] - point);
    const DVec3 b = glm::normalize(corners[(i + 1) % corners.size()] - point);
    const DVec3 across = glm::cross(a, b);
    const double sine = glm::length(across);
    if (sine > 0.0) sum += std::atan2(sine, glm::dot(a, b)) * glm::dot(normal, across / sine);
  }
  return 0.5 * std::abs(sum);
}

}  // namespace macula::test
