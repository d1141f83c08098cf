// Structures of arrays for up to kBatch items: what loops over vectors read and write, whole
// vectors at a time, so that the entries from the item count up to the next multiple of the
// vector's width are read and overwritten too. Make them zero before first use.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "shared/math/vec.h"

namespace macula::sampling {

/// A multiple of every vector's width.
inline constexpr std::size_t kBatch = 256;

struct alignas(64) FloatBatch {
  float at[kBatch];

  /// Takes the first `count` of `from` over as entries from `first` on.
  void copy(std::size_t first, const FloatBatch& from, std::size_t count) {
    std::copy_n(from.at, count, at + first);
  }
};
struct alignas(64) IndexBatch {
  std::uint32_t at[kBatch];
};
struct alignas(64) Vec2Batch {
  float x[kBatch], y[kBatch];

  Vec2 operator[](std::size_t i) const { return {x[i], y[i]}; }
};
struct alignas(64) Vec3Batch {
  float x[kBatch], y[kBatch], z[kBatch];

  Vec3 operator[](std::size_t i) const { return {x[i], y[i], z[i]}; }
  void set(std::size_t i, const Vec3& v) { x[i] = v.x, y[i] = v.y, z[i] = v.z; }
  void copy(std::size_t first, const Vec3Batch& from, std::size_t count) {
    std::copy_n(from.x, count, x + first), std::copy_n(from.y, count, y + first);
    std::copy_n(from.z, count, z + first);
  }
};

}  // namespace macula::sampling
