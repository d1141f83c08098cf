// Points along the Morton curve: 63-bit codes, 21 bits an axis, sorted by a radix sort that keeps
// the order of equal codes, so coincident points follow one another by index. O(n) unless most
// points share the upper 33 bits; keeps its memory from call to call. One thread at a time.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

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
  struct Key {
    std::uint64_t code;
    std::uint32_t index;
  };
  void sort_keys();
  void sort_runs();

  std::vector<Key> keys_, scratch_;
  std::vector<std::uint32_t> order_;
};

}  // namespace macula::lights
