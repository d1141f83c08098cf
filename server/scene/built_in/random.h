// Chance for generators: a pure function of its seed, the same on every machine and in every run.
#pragma once

#include <cmath>
#include <cstdint>

#include "shared/math/hash.h"
#include "shared/math/vec.h"

namespace macula::scene::built_in {

/// Numbers in order: the n-th call of two dice with the same seed agrees.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : seed_(seed) {}
  /// In [0, 1).
  float next() { return math::unit_float(math::hash_combine(seed_, count_++)); }
  float in(float low, float high) { return low + (high - low) * next(); }
  /// In [0, count).
  int below(int count) { return static_cast<int>(next() * static_cast<float>(count)); }
  bool chance(float share) { return next() < share; }

 private:
  std::uint64_t seed_;
  std::uint64_t count_ = 0;
};

/// Value noise in [-1, 1] with one lattice point a unit, smoothed (C1): roughness for surfaces that
/// are displaced rather than painted.
inline float roughness(const Vec3& at, std::uint64_t seed) {
  const Vec3 cell = glm::floor(at), t = at - cell;
  const Vec3 s = t * t * (Vec3{3.0F} - 2.0F * t);
  const auto value = [&cell, seed](int dx, int dy, int dz) {
    const auto key = [](float c, int d) {
      return static_cast<std::uint64_t>(static_cast<std::int64_t>(c) + d) & 0x1FFFFF;
    };
    const std::uint64_t lattice =
        key(cell.x, dx) | (key(cell.y, dy) << 21) | (key(cell.z, dz) << 42);
    return 2.0F * math::unit_float(math::hash_combine(seed, lattice)) - 1.0F;
  };
  const auto along_x = [&](int dy, int dz) {
    return glm::mix(value(0, dy, dz), value(1, dy, dz), s.x);
  };
  return glm::mix(glm::mix(along_x(0, 0), along_x(1, 0), s.y),
                  glm::mix(along_x(0, 1), along_x(1, 1), s.y), s.z);
}

}  // namespace macula::scene::built_in
