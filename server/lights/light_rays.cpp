#include "server/lights/light_rays.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/sampling/frame.h"
#include "server/sampling/mappings.h"

namespace macula::lights {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

LightRay ray_from_within(const scene::Light& light, const Vec2& u) {
  return {light.position, Vec3{0.0F}, 0.0F, sampling::uniform_sphere(u),
          light.intensity * (4.0F * kPi)};
}

/// A direction about an axis, in double: floats cannot aim at a scene from a million times its
/// size.
DVec3 direction_about(const DVec3& axis, double one_minus_cosine, double turn) {
  const DVec3 beside = glm::normalize(
      glm::cross(axis, std::abs(axis.x) < 0.5 ? DVec3{1.0, 0.0, 0.0} : DVec3{0.0, 1.0, 0.0}));
  const double sine = std::sqrt(one_minus_cosine * (2.0 - one_minus_cosine));
  return (1.0 - one_minus_cosine) * axis +
         sine * (std::cos(turn) * beside + std::sin(turn) * glm::cross(axis, beside));
}

/// Evenly over the directions that meet the ball about `lit`, from just before it.
LightRay ray_towards(const scene::Light& light, const scene::Bounds& lit, const Vec2& u) {
  const DVec3 arm = lit.centre() - light.position;
  const double distance = glm::length(arm), radius = 0.5 * glm::length(lit.size());
  const double sine2 = radius / distance * (radius / distance);
  const double one_minus_cosine = sine2 / (1.0 + std::sqrt(1.0 - sine2));
  const DVec3 direction =
      direction_about(arm / distance, static_cast<double>(u.x) * one_minus_cosine,
                      2.0 * std::numbers::pi * static_cast<double>(u.y));
  const DVec3 origin = light.position + std::max(0.0, distance - 2.0 * radius) * direction;
  return {origin, Vec3{0.0F}, 0.0F, Vec3(direction),
          light.intensity * static_cast<float>(2.0 * std::numbers::pi * one_minus_cosine)};
}

LightRay ray_from_point(const scene::Light& light, const scene::Bounds& lit, const Vec2& u) {
  if (lit.empty()) return ray_from_within(light, u);
  const bool outside = glm::length(lit.centre() - light.position) > 0.5 * glm::length(lit.size());
  return outside ? ray_towards(light, lit, u) : ray_from_within(light, u);
}

/// glTF's spot over cosines: 1 from the axis to the inner cone, a squared ramp on to the outer.
struct SpotProfile {
  double outer, inner;  ///< cosines, outer <= inner

  explicit SpotProfile(const scene::Light& light)
      : outer(std::cos(light.outer_cone.value())),
        inner(std::max(std::cos(light.inner_cone.value()), outer)) {}
  double full() const { return 1.0 - inner; }
  double ramp() const { return (inner - outer) / 3.0; }
  /// Its integral inverted: as many directions as it has light, for u in [0, 1).
  double cosine(double u) const {
    const double within = u * (full() + ramp());
    if (within <= full()) return 1.0 - within;
    const double left = std::max(0.0, 1.0 - (within - full()) / ramp());
    return outer + (inner - outer) * std::cbrt(left);
  }
};

LightRay ray_from_spot(const scene::Light& light, const Vec2& u) {
  const SpotProfile profile(light);
  const double cosine = profile.cosine(static_cast<double>(u.x));
  const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
  const double turn = 2.0 * std::numbers::pi * static_cast<double>(u.y);
  const Vec3 local(DVec3(sine * std::cos(turn), sine * std::sin(turn), cosine));
  return {light.position, Vec3{0.0F}, 0.0F, sampling::frame_from_normal(light.direction) * local,
          light.intensity * (2.0F * kPi * static_cast<float>(profile.full() + profile.ramp()))};
}

/// Distance from the axis through the box's centre to its farthest corner.
double radius_across(const scene::Bounds& box, const DVec3& axis) {
  double radius2 = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const DVec3 sign(corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0, corner & 4 ? 1.0 : -1.0);
    const DVec3 arm = 0.5 * sign * box.size();
    const DVec3 across = arm - glm::dot(arm, axis) * axis;
    radius2 = std::max(radius2, glm::dot(across, across));
  }
  return std::sqrt(radius2);
}

LightRay ray_from_afar(const scene::Light& light, const scene::Bounds& lit, const Vec2& u) {
  if (lit.empty()) return {};
  const DVec3 axis(light.direction);
  const double radius = radius_across(lit, axis);
  const Vec2 at = sampling::uniform_disk(u);
  const Mat3 frame = sampling::frame_from_normal(light.direction);
  const DVec3 across = radius * DVec3(frame * Vec3(at, 0.0F));
  // A whole diagonal before the centre: half of one is before the box, the rest before rounding.
  const DVec3 origin = lit.centre() + across - glm::length(lit.size()) * axis;
  const double area = std::numbers::pi * radius * radius;
  return {origin, Vec3{0.0F}, 0.0F, light.direction, light.intensity * static_cast<float>(area)};
}

}  // namespace

LightRay ray_from(const scene::Light& light, const scene::Bounds& lit, const Vec2& u) {
  switch (light.kind) {
    case scene::LightKind::Point:
      return ray_from_point(light, lit, u);
    case scene::LightKind::Spot:
      return ray_from_spot(light, u);
    case scene::LightKind::Directional:
      return ray_from_afar(light, lit, u);
  }
  return {};
}

LightRay ray_from_area(const LightList& list, const Vec2& u_place, const Vec2& u_direction,
                       const shading::SurfaceTable& surfaces,
                       const shading::MaterialTable& materials) {
  const AreaSample sample = list.sample_area(u_place);
  const EmissiveTriangle& lamp = list.emissive()[sample.light];
  const Vec3 direction =
      sampling::frame_from_normal(lamp.normal) * sampling::cosine_hemisphere(u_direction);
  if (!(sample.pdf_per_m2 > 0.0F)) return {};
  const Rgb emission = list.emission(sample.light, sample.barycentric, surfaces, materials);
  const float span = surfaces.at(lamp.instance, lamp.triangle, sample.barycentric).span_m;
  return {sample.position, lamp.normal, span, direction, emission * (kPi / sample.pdf_per_m2)};
}

}  // namespace macula::lights
