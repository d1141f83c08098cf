#include "server/lights/light_bounds.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace macula::lights {
namespace {

bool is_usable(double intensity) {
  return intensity > 0.0 && std::isfinite(intensity);
}

/// x >= 0.
float rounded_up(double x) {
  const auto nearest = static_cast<float>(x);
  const auto next = std::bit_cast<float>(std::bit_cast<std::uint32_t>(nearest) + 1U);
  return static_cast<double>(nearest) < x ? next : nearest;
}
Vec3 rounded_up(const DVec3& v) {
  return {rounded_up(v.x), rounded_up(v.y), rounded_up(v.z)};
}

void enclose(const DVec3& point, LightBounds& bounds) {
  bounds.centre = Vec3(point);
  bounds.half = rounded_up(glm::abs(point - DVec3(bounds.centre)));
}
void enclose(const DVec3& p0, const DVec3& p1, const DVec3& p2, LightBounds& bounds) {
  const DVec3 low = glm::min(p0, glm::min(p1, p2)), high = glm::max(p0, glm::max(p1, p2));
  bounds.centre = Vec3(0.5 * (low + high));
  bounds.half = rounded_up(glm::max(high - DVec3(bounds.centre), DVec3(bounds.centre) - low));
}

template <class Light>
std::optional<LightBounds> optional_bounds(const Light& light) {
  LightBounds bounds;
  if (!write_bounds(light, bounds)) return std::nullopt;
  return bounds;
}

}  // namespace

bool write_bounds(const scene::Light& light, LightBounds& bounds) {
  const double intensity = image::luminance(light.intensity);
  if (light.kind == scene::LightKind::Directional || !is_usable(intensity) ||
      !math::is_finite(light.position)) {
    return false;
  }
  bounds.intensity = intensity;
  enclose(light.position, bounds);
  if (light.kind == scene::LightKind::Point) {
    const LightBounds everywhere;
    bounds.axis = everywhere.axis;
    bounds.half_sine = everywhere.half_sine, bounds.cos_emission = everywhere.cos_emission;
    return true;
  }
  // Between its cones a spot's squared ramp stays below the cosine of the angle to the inner one.
  const double inner = light.inner_cone.value(), outer = light.outer_cone.value();
  bounds.axis = light.direction;
  bounds.half_sine = static_cast<float>(std::sin(0.5 * inner));
  bounds.cos_emission = static_cast<float>(std::cos(std::max(outer - inner, 0.0)));
  return true;
}

bool write_bounds(const EmissiveTriangle& light, LightBounds& bounds) {
  const double intensity =
      static_cast<double>(light.area_m2) * image::luminance(light.mean_emission);
  const DVec3 p1 = light.position + DVec3(light.edge1), p2 = light.position + DVec3(light.edge2);
  if (!is_usable(intensity) || !math::is_finite(light.position) || !math::is_finite(p1) ||
      !math::is_finite(p2)) {
    return false;
  }
  bounds.intensity = intensity;
  enclose(light.position, p1, p2, bounds);
  bounds.axis = light.normal;
  bounds.half_sine = 0.0F, bounds.cos_emission = 0.0F;
  return true;
}

std::optional<LightBounds> bounds_of(const scene::Light& light) {
  return optional_bounds(light);
}
std::optional<LightBounds> bounds_of(const EmissiveTriangle& light) {
  return optional_bounds(light);
}

}  // namespace macula::lights
