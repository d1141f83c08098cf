#include "server/kernels/lightcuts/other_eye.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/reconstruction/light_planes.h"
#include "shared/image/color.h"

namespace macula::kernels::lightcuts {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
/// A channel that reflects less has no light to tell from.
constexpr float kLeastReflectance = 1e-3F;

Rgb reflectance(const ray::LitPoints& points, std::size_t i) {
  return glm::max(points.reflectors.reflectance[i], Rgb{kLeastReflectance});
}

}  // namespace

OtherEye::OtherEye(const View& lit, const ViewSurfaces& surfaces, const Plane<Rgb>& light,
                   const View& view)
    : surfaces_(surfaces),
      light_(light),
      lit_eye_(lit.world_from_view.position),
      eye_(view.world_from_view.position),
      ahead_(-glm::mat3_cast(view.world_from_view.rotation)[2]),
      warp_(view.world_from_view, view.grid, lit.world_from_view, lit.grid),
      areas_there_(lit.grid),
      areas_(view.grid) {}

std::optional<Rgb> OtherEye::light(const SurfaceTile& tile, std::size_t i) const {
  if (!looks_alike(tile.points, i)) return {};
  const float depth = glm::dot(tile.points.position[i] - eye_, ahead_);
  if (!(depth > 0.0F)) return {};
  const image::Pixel cell = tile.pixel(i);
  const auto place = warp_.then(cell.x, cell.y, 1.0F / depth);
  const float px = place.x - 0.5F, py = place.y - 0.5F;
  const auto width = static_cast<float>(surfaces_.width);
  const auto height = static_cast<float>(surfaces_.height);
  if (!(place.inverse_depth > 0.0F && px > -1.0F && px < width && py > -1.0F && py < height))
    return {};
  const int left = static_cast<int>(std::floor(px)), top = static_cast<int>(std::floor(py));
  const float fx = px - static_cast<float>(left), fy = py - static_cast<float>(top);
  Rgb sum{0.0F};
  float weights = 0.0F;
  for (int k = 0; k < 4; ++k) {
    const int x = left + k % 2, y = top + k / 2;
    if (x < 0 || y < 0 || x >= surfaces_.width || y >= surfaces_.height) continue;
    const SurfaceAt there = surfaces_.at(x, y);
    if (!there || !shows_same(there, tile.points, i)) continue;
    constexpr float kLeastWorth = 0.5F;  // a cell twice as wide would blur
    if (reconstruction::worth(areas_.at(cell.x, cell.y), areas_there_.at(x, y)) < kLeastWorth)
      continue;
    const float weight = (k % 2 == 0 ? 1.0F - fx : fx) * (k / 2 == 0 ? 1.0F - fy : fy);
    sum += weight * light_(x, y) / reflectance(*there.points, there.index);
    weights += weight;
  }
  // With less, most of what lies around the place is another surface: its edge, lit elsewhere.
  constexpr float kLeastShare = 0.5F;
  if (!(weights >= kLeastShare)) return {};
  const Rgb light = sum * reflectance(tile.points, i) / weights;
  return math::is_finite(light) ? std::optional(light) : std::nullopt;
}

/// Closer than a denoiser asks for: what lies behind an edge, seen along its plane, is another
/// surface here.
bool OtherEye::shows_same(const SurfaceAt& there, const ray::LitPoints& points,
                          std::size_t i) const {
  constexpr float kApartOfBetween = reconstruction::kApartOfBetween / 4.0F;
  const Vec3 normal = points.reflectors.shading[i];
  if (glm::dot(normal, there.normal()) < reconstruction::kLeastFacing) return false;
  const Vec3 between = there.position() - points.position[i];
  const float allowed = kApartOfBetween * glm::length(between) +
                        reconstruction::kApartOfDistance * glm::length(points.position[i] - eye_);
  return std::abs(glm::dot(normal, between)) <= allowed;
}

/// GGX with tan t = slope is 1 / (1 + (t / alpha)^2)^2 of its peak: its logarithm changes by at
/// most 2 / alpha a radian, and half vectors turn by half the angle between the eyes. The lobe's
/// share at its peak is f0 / (4 pi alpha^2) against the diffuse term's albedo / pi.
bool OtherEye::looks_alike(const ray::LitPoints& points, std::size_t i) const {
  const float alpha = points.reflectors.alpha.at[i];
  if (!(alpha > 0.0F)) return true;
  const Vec3 to_lit = glm::normalize(lit_eye_ - points.position[i]);
  const float angle = glm::length(to_lit - points.reflectors.to_eye[i]);
  const float peak = image::luminance(points.reflectors.f0[i]) / (4.0F * kPi * alpha * alpha);
  const float all = peak + image::luminance(points.reflectors.diffuse[i]);
  return peak * angle <= kMostChange * alpha * all;
}

}  // namespace macula::kernels::lightcuts
