#include "server/lights/virtual_point_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace macula::lights {

std::optional<Arrival> arriving(const VirtualPointLight& light, const DVec3& point,
                                double least_m) {
  const DVec3 to_light = light.position - point;
  const double distance2 = glm::dot(to_light, to_light);
  const double distance = std::sqrt(distance2);
  const double height = -glm::dot(to_light, DVec3(light.normal));
  if (!(height > 0.0)) return std::nullopt;
  const double least = std::min(least_m, static_cast<double>(light.footprint_m));
  const double counted2 = std::max(distance2, least * least);
  const double share = height / (std::numbers::pi * counted2 * distance);
  return Arrival{Vec3(to_light / distance), static_cast<float>(distance),
                 light.flux * static_cast<float>(share)};
}

}  // namespace macula::lights
