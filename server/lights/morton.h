// Points along the Morton curve: 63-bit codes, 21 bits an axis, sorted by a radix sort that keeps
// the order of equal codes, so coincident points follow one another by index. O(n) unless most
// points share the upper 32 bits; keeps its memory from call to call. One thread at a time.
#pragma once

#include <cstdint>
#include <span>
#include "shared/base/big_vector.h"
#include "shared/math/vec.h"

namespace macula::lights {

/// Interleaved bits z y x z y x ... of coordinates in [0, 2^21).
std::uint64_t morton_code(std::uint32_t x, std::uint32_t y, std::uint32_t z);

class MortonOrder {
 public:
  /// order[k]: index of the k-th point along the curve through the cube about all points, which
  /// must be finite. Valid until the next call. Cubes, not boxes: cells that are long in one
  /// direction would make poor clusters, and an extent of 0 needs no case of its own.
  std::span<const std::uint32_t> sort(std::span<const Vec3> points);

 private:
  void sort_upper_bits();
  void sort_runs();

  base::BigVector<std::uint64_t> codes_;           ///< by point
  base::BigVector<std::uint64_t> keys_, scratch_;  ///< upper 32 bits of a code, index
  base::BigVector<std::uint32_t> order_;
};

}  // namespace macula::lights
