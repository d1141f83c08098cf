#include "server/lights/light_bounds.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>

namespace macula::lights {
namespace {

bool is_usable(double intensity) {
  return intensity > 0.0 && std::isfinite(intensity);
}

float rounded_up(double x) {
  const auto nearest = static_cast<float>(x);
  return static_cast<double>(nearest) < x
             ? std::nextafter(nearest, std::numeric_limits<float>::infinity())
             : nearest;
}

void enclose(std::initializer_list<DVec3> points, LightBounds& bounds) {
  DVec3 low = *points.begin(), high = low;
  for (const DVec3& point : points) low = glm::min(low, point), high = glm::max(high, point);
  bounds.centre = Vec3(0.5 * (low + high));
  const DVec3 reach = glm::max(high - DVec3(bounds.centre), DVec3(bounds.centre) - low);
  bounds.half = {rounded_up(reach.x), rounded_up(reach.y), rounded_up(reach.z)};
}

}  // namespace

std::optional<LightBounds> bounds_of(const scene::Light& light) {
  const double intensity = image::luminance(light.intensity);
  if (light.kind == scene::LightKind::Directional || !is_usable(intensity) ||
      !math::is_finite(light.position)) {
    return std::nullopt;
  }
  LightBounds bounds;
  bounds.intensity = intensity;
  enclose({light.position}, bounds);
  if (light.kind == scene::LightKind::Point) return bounds;
  // Between its cones a spot's squared ramp stays below the cosine of the angle to the inner one.
  const double inner = light.inner_cone.value(), outer = light.outer_cone.value();
  bounds.axis = light.direction;
  bounds.half_sine = static_cast<float>(std::sin(0.5 * inner));
  bounds.cos_emission = static_cast<float>(std::cos(std::max(outer - inner, 0.0)));
  return bounds;
}

std::optional<LightBounds> bounds_of(const EmissiveTriangle& light) {
  const double intensity =
      static_cast<double>(light.area_m2) * image::luminance(light.mean_emission);
  const DVec3 p1 = light.position + DVec3(light.edge1), p2 = light.position + DVec3(light.edge2);
  if (!is_usable(intensity) || !math::is_finite(light.position) || !math::is_finite(p1) ||
      !math::is_finite(p2)) {
    return std::nullopt;
  }
  LightBounds bounds;
  bounds.intensity = intensity;
  enclose({light.position, p1, p2}, bounds);
  bounds.axis = light.normal;
  bounds.half_sine = 0.0F;
  return bounds;
}

}  // namespace macula::lights
