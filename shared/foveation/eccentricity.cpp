#include "shared/foveation/eccentricity.h"

#include <cmath>

namespace macula::foveation {

Radians eccentricity(const DVec3& gaze, const DVec3& direction) {
  return Radians{std::atan2(glm::length(glm::cross(gaze, direction)), glm::dot(gaze, direction))};
}

Radians eccentricity(const Vec3& gaze, const Vec3& direction) {
  return eccentricity(DVec3(gaze), DVec3(direction));
}

}  // namespace macula::foveation
