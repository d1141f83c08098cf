// Independent samples: a pure function of who asks, so that a picture does not depend on threads,
// tiles or history, and the same cell gets the same samples in every grid. Uniform in [0, 1), 24
// bits.
#pragma once

#include <cstdint>

#include "shared/math/hash.h"
#include "shared/math/vec.h"

namespace macula::sampling {

/// Hash of everything about a sample but its dimension; a kernel makes it once a cell.
struct SampleKey {
  std::uint64_t value = 0;

  SampleKey() = default;
  /// `cell` is PixelGrid::cell_key or a hash of one's own.
  constexpr SampleKey(std::uint64_t seed, std::uint64_t frame, std::uint64_t cell)
      : value(math::hash_combine(math::hash_combine(seed, frame), cell)) {}
};

constexpr float sample(SampleKey key, std::uint32_t dimension) {
  return math::unit_float(math::hash_combine(key.value, dimension));
}
/// Dimensions `dimension` and `dimension + 1`.
inline Vec2 sample_2d(SampleKey key, std::uint32_t dimension) {
  return {sample(key, dimension), sample(key, dimension + 1)};
}
constexpr float sample(std::uint64_t seed, std::uint64_t frame, std::uint64_t cell,
                       std::uint32_t dimension) {
  return sample(SampleKey(seed, frame, cell), dimension);
}
/// 32 bits for number `index` of a sequence that independent samples draw in one dimension.
constexpr std::uint32_t sample_bits(SampleKey key, std::uint32_t dimension, std::uint64_t index) {
  const std::uint64_t sequence = math::hash_combine(key.value, dimension);
  return static_cast<std::uint32_t>(math::hash_combine(sequence, index) >> 32);
}
/// 32 bits for sobol_owen_2d: each pair of dimensions of a cell has its own scrambling.
constexpr std::uint32_t scramble_seed(SampleKey key, std::uint32_t dimension) {
  return static_cast<std::uint32_t>(math::hash_combine(key.value, dimension) >> 32);
}

}  // namespace macula::sampling
