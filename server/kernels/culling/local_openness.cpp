#include "server/kernels/culling/local_openness.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "server/sampling/frame.h"

namespace macula::kernels::culling {
namespace {

constexpr int kSide = 64;
constexpr float kNear = 0.02F;         ///< radius of the positions, of half the extent
constexpr float kThreshold = 1e-3F;    ///< xi, of the extent
constexpr float kAttenuation = 34.0F;  ///< k, per root of the extent
constexpr int kPositions = 8;          ///< N'
constexpr Degrees kCone{25.0};

/// Octahedral map of directions onto [0, 1]^2 (Meyer et al. 2010).
Vec2 square_from_direction(const Vec3& d) {
  const Vec3 n = d / (std::abs(d.x) + std::abs(d.y) + std::abs(d.z));
  Vec2 p{n.x, n.y};
  if (n.z < 0.0F) {
    p = {std::copysign(1.0F - std::abs(n.y), n.x), std::copysign(1.0F - std::abs(n.x), n.y)};
  }
  return 0.5F * p + 0.5F;
}
Vec3 direction_from_square(const Vec2& square) {
  const Vec2 p = 2.0F * square - 1.0F;
  Vec3 n{p.x, p.y, 1.0F - std::abs(p.x) - std::abs(p.y)};
  if (n.z < 0.0F) {
    n.x = std::copysign(1.0F - std::abs(p.y), p.x);
    n.y = std::copysign(1.0F - std::abs(p.x), p.y);
  }
  return glm::normalize(n);
}

std::size_t texel_of(const Vec3& direction) {
  const Vec2 at = static_cast<float>(kSide) * square_from_direction(direction);
  const int x = std::clamp(static_cast<int>(at.x), 0, kSide - 1);
  const int y = std::clamp(static_cast<int>(at.y), 0, kSide - 1);
  return static_cast<std::size_t>(y * kSide + x);
}

std::vector<float> distances_from(const Vec3& lamp, const SceneFrame& scene,
                                  scheduling::TileScheduler& scheduler) {
  std::vector<float> distance(static_cast<std::size_t>(kSide) * kSide,
                              std::numeric_limits<float>::infinity());
  constexpr std::size_t kStep = visibility::kStreamCapacity;
  scheduler.run(distance.size() / kStep, [&](std::size_t batch) {
    visibility::RayStream rays;
    visibility::HitStream hits;
    for (std::size_t i = batch * kStep; i < (batch + 1) * kStep; ++i) {
      const Vec2 texel{static_cast<float>(i % kSide) + 0.5F, static_cast<float>(i / kSide) + 0.5F};
      rays.push(lamp, direction_from_square(texel / static_cast<float>(kSide)), 0.0F,
                std::numeric_limits<float>::infinity());
    }
    scene.intersect(rays, hits, visibility::Coherence::Incoherent);
    for (int i = 0; i < rays.count; ++i)
      if (hits.hit(i)) distance[batch * kStep + static_cast<std::size_t>(i)] = hits.t[i];
  });
  return distance;
}

/// Positions in the cone about +Z, of radius 1, evenly spread over its volume.
std::array<Vec3, kPositions> cone_positions() {
  std::array<Vec3, kPositions> positions;
  const double least = std::cos(Radians{kCone}.value());
  for (int k = 0; k < kPositions; ++k) {
    const double turn = 2.0 * std::numbers::pi * std::numbers::phi * k;
    const double z = 1.0 - (1.0 - least) * (k + 0.5) / kPositions;
    const double far = std::cbrt(((k * 5) % kPositions + 0.5) / kPositions);
    const double s = std::sqrt(1.0 - z * z);
    positions[static_cast<std::size_t>(k)] =
        Vec3(far * DVec3{s * std::cos(turn), s * std::sin(turn), z});
  }
  return positions;
}

/// g of a depth difference in extents: negative in front of what the map holds.
float openness_of(float dh) {
  if (dh <= -kThreshold) return 1.0F;
  if (dh < kThreshold) return 0.0F;
  return 1.0F - std::exp(-kAttenuation * std::sqrt(dh));
}

}  // namespace

std::size_t Openness::index_of(const Vec3& direction) {
  // A component below sin(22.5 degrees) is as good as none.
  const auto third = [](float c) { return c > 0.383F ? 2 : (c < -0.383F ? 0 : 1); };
  return static_cast<std::size_t>(third(direction.x) + 3 * third(direction.y) +
                                  9 * third(direction.z));
}

LampMaps::LampMaps(const SceneFrame& scene, float extent_m, scheduling::TileScheduler& scheduler)
    : extent_m_(extent_m) {
  for (const scene::Light& light : scene.lights().punctual()) {
    if (light.kind == scene::LightKind::Directional) continue;
    const Vec3 lamp(light.position);
    maps_.push_back({lamp, distances_from(lamp, scene, scheduler)});
    rays_ += maps_.back().distance_m.size();
  }
}

float LampMaps::seen(const Vec3& position) const {
  float most = 0.0F;
  for (const Map& map : maps_) {
    const Vec3 from_lamp = position - map.lamp;
    const float distance = glm::length(from_lamp);
    const float held = distance > 0.0F ? map.distance_m[texel_of(from_lamp / distance)] : 0.0F;
    most = std::max(most, openness_of((distance - held) / extent_m_));
  }
  return most;
}

Openness LampMaps::around(const Vec3& place, const Vec3& normal) const {
  static const std::array<Vec3, kPositions> kAround = cone_positions();
  Openness open;
  open.share_.fill(1.0F);
  if (maps_.empty()) return open;
  const float radius = 0.5F * kNear * extent_m_;
  for (int i = 0; i < Openness::kDirections; ++i) {
    const Vec3 cell(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    if (cell == Vec3{0.0F}) continue;
    const Vec3 direction = glm::normalize(cell);
    if (glm::dot(direction, normal) < -0.5F) continue;  // nothing is asked there
    const Mat3 frame = sampling::frame_from_normal(direction);
    float sum = 0.0F;
    for (const Vec3& at : kAround) sum += seen(place + radius * (frame * at));
    open.share_[static_cast<std::size_t>(i)] = sum / static_cast<float>(kPositions);
  }
  return open;
}

}  // namespace macula::kernels::culling
