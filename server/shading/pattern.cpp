#include "server/shading/pattern.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "server/shading/pattern_lattice.h"

namespace macula::shading {
namespace {

/// A pulse train of period 1 that is 1 on [0, duty) and 0 on the rest of every period, averaged
/// over [x - width / 2, x + width / 2]: the difference of its integral over the width.
float pulses(float x, float duty, float width) {
  const auto whole = [](float v) { return v - std::floor(v); };
  if (width <= 0.0F) return whole(x) < duty ? 1.0F : 0.0F;
  const auto integral = [&](float v) { return std::floor(v) * duty + std::min(whole(v), duty); };
  // Relative to the period that x lies in: integrals far from 0 would lose the small difference.
  const float local = whole(x);
  const float mean = (integral(local + 0.5F * width) - integral(local - 0.5F * width)) / width;
  return std::clamp(mean, 0.0F, 1.0F);
}

/// The two coordinates across the normal's largest axis; the second is up on walls.
Vec2 across(const Vec3& position, const Vec3& normal) {
  const Vec3 n = glm::abs(normal);
  if (n.y >= n.x && n.y >= n.z) return {position.x, position.z};
  return n.x >= n.z ? Vec2{position.z, position.y} : Vec2{position.x, position.y};
}

/// Squares where both coordinates lie in the same half of their periods, or both do not: with
/// s = 2 p - 1 the product of two independent means is the mean of the product.
float checker(const Vec2& at, const Vec2& width) {
  const float u = 2.0F * pulses(0.5F * at.x, 0.5F, 0.5F * width.x) - 1.0F;
  const float v = 2.0F * pulses(0.5F * at.y, 0.5F, 0.5F * width.y) - 1.0F;
  return 0.5F - 0.5F * u * v;
}

float bricks(const Vec2& at, const Vec2& width) {
  const float course = std::floor(at.y);
  const float shift = std::fmod(std::abs(course), 2.0F) < 0.5F ? 0.0F : 0.5F;
  const float upright = pulses(0.5F * at.x + shift, 0.5F * kJoint, 0.5F * width.x);
  const float level = pulses(at.y, kJoint, width.y);
  return 1.0F - (1.0F - upright) * (1.0F - level);
}

/// In [0, 1): a hash of a lattice corner, in 32 bits so that vectors need not widen.
float lattice(int x, int y, int z) {
  std::uint32_t h = kLatticeX * static_cast<std::uint32_t>(x) ^
                    kLatticeY * static_cast<std::uint32_t>(y) ^
                    kLatticeZ * static_cast<std::uint32_t>(z);
  h = (h ^ h >> 15U) * kLatticeMix[0];
  h = (h ^ h >> 12U) * kLatticeMix[1];
  h ^= h >> 15U;
  return static_cast<float>(h >> 8U) * 0x1p-24F;
}

/// Values at whole numbers, between them the smoothest cubic without slope at its ends.
float value_noise(const Vec3& at) {
  const Vec3 cell = glm::floor(at);
  const Vec3 f = at - cell;
  const Vec3 w = f * f * (3.0F - 2.0F * f);
  const int x = static_cast<int>(cell.x), y = static_cast<int>(cell.y),
            z = static_cast<int>(cell.z);
  const auto row = [&](int dy, int dz) {
    return glm::mix(lattice(x, y + dy, z + dz), lattice(x + 1, y + dy, z + dz), w.x);
  };
  return glm::mix(glm::mix(row(0, 0), row(1, 0), w.y), glm::mix(row(0, 1), row(1, 1), w.y), w.z);
}

/// Two octaves; each fades to its mean while its period shrinks from two footprints to one.
float noise(const Vec3& at, float width) {
  float sum = 0.5F, amplitude = 2.0F / 3.0F, frequency = 1.0F;
  for (int octave = 0; octave < 2; ++octave) {
    const float seen = std::clamp(2.0F - 2.0F * width * frequency, 0.0F, 1.0F);
    if (seen > 0.0F) sum += seen * amplitude * (value_noise(at * frequency) - 0.5F);
    amplitude *= 0.5F, frequency *= 2.0F;
  }
  return std::clamp(sum, 0.0F, 1.0F);
}

}  // namespace

float second_share(const scene::Pattern& pattern, const PatternPoint& point) {
  const float per_size = 1.0F / pattern.size_m;
  const Vec3 width = per_size * point.footprint_m;
  switch (pattern.kind) {
    case scene::PatternKind::Checker:
      return checker(per_size * across(point.position, point.normal), across(width, point.normal));
    case scene::PatternKind::Bricks:
      return bricks(per_size * across(point.position, point.normal), across(width, point.normal));
    case scene::PatternKind::Stripes:
      return pulses(0.5F * per_size * point.position.y, 0.5F, 0.5F * width.y);
    case scene::PatternKind::Noise:
      return noise(per_size * point.position, std::max({width.x, width.y, width.z}));
  }
  return 0.0F;
}

// With n the normal, t the direction of sight laid into the surface and b across both,
// n n' + t t' + b b' = 1 gives b's parts.
Vec3 covered_box(const Vec3& normal, const Vec3& to_eye, float width_m) {
  constexpr float kLeastCosine = 1.0F / 64.0F;  // beyond it, blur would spread to the horizon
  const float cosine = glm::dot(normal, to_eye);
  const Vec3 laid = to_eye - cosine * normal;
  const float length = glm::length(laid);
  if (!(length > 0.0F)) return Vec3{width_m};
  const Vec3 along = laid / length;
  const float stretch = 1.0F / std::max(std::abs(cosine), kLeastCosine);
  const Vec3 along_squared = along * along;
  const Vec3 across_squared = glm::max(Vec3{1.0F} - normal * normal - along_squared, Vec3{0.0F});
  return width_m * glm::sqrt(across_squared + stretch * stretch * along_squared);
}

}  // namespace macula::shading
