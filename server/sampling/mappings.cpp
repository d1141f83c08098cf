#include "server/sampling/mappings.h"

#include <algorithm>
#include <numbers>

namespace macula::sampling {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

/// Direction at height z and azimuth phi. 1 - z^2 as a product keeps its digits near the pole.
Vec3 direction_at(float z, float phi) {
  const float radius = std::sqrt(std::max(0.0F, (1.0F - z) * (1.0F + z)));
  return {radius * std::cos(phi), radius * std::sin(phi), z};
}

}  // namespace

Vec2 uniform_disk(const Vec2& u) {
  const Vec2 square = 2.0F * u - 1.0F;
  if (square.x == 0.0F && square.y == 0.0F) return Vec2{0.0F};
  const bool wide = std::abs(square.x) > std::abs(square.y);
  const float radius = wide ? square.x : square.y;
  const float angle =
      wide ? kPi / 4.0F * (square.y / square.x) : kPi / 2.0F - kPi / 4.0F * (square.x / square.y);
  return radius * Vec2{std::cos(angle), std::sin(angle)};
}

Vec3 cosine_hemisphere(const Vec2& u) {
  const Vec2 disk = uniform_disk(u);
  return {disk.x, disk.y, std::sqrt(std::max(0.0F, 1.0F - glm::dot(disk, disk)))};
}

Vec3 uniform_hemisphere(const Vec2& u) {
  return direction_at(u.x, 2.0F * kPi * u.y);
}

Vec3 uniform_sphere(const Vec2& u) {
  return direction_at(1.0F - 2.0F * u.x, 2.0F * kPi * u.y);
}

Vec2 uniform_triangle(const Vec2& u) {
  // Folds the square along its diagonal y = x, then shears each half onto the triangle.
  if (u.y > u.x) return {0.5F * u.x, u.y - 0.5F * u.x};
  return {u.x - 0.5F * u.y, 0.5F * u.y};
}

}  // namespace macula::sampling
