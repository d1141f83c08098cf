// Points along the Morton curve: 63-bit codes, 21 bits an axis, sorted by a radix sort that keeps
// the order of equal codes, so coincident points follow one another by index. Two digits tell
// nearly all points apart; what they leave equal is sorted run by run, so that it is O(n) unless
// most points share the upper 32 bits. Keeps its memory from call to call. One thread at a time.
#pragma once

#include <cstdint>
#include <span>
#include "shared/base/big_vector.h"
#include "shared/math/vec.h"

namespace macula::lights {

/// Interleaved bits z y x z y x ... of coordinates in [0, 2^21).
std::uint64_t morton_code(std::uint32_t x, std::uint32_t y, std::uint32_t z);

/// A cube that holds all points. Cubes, not boxes: cells that are long in one direction would make
/// poor clusters, and an extent of 0 needs no case of its own.
struct MortonCube {
  DVec3 corner{0.0};             ///< the lowest one
  double cells_per_meter = 0.0;  ///< 0 where all points coincide
};
/// The least one about the box from `low` to `high`.
MortonCube cube_about(const Vec3& low, const Vec3& high);

class MortonOrder {
 public:
  /// order[k]: index of the k-th point along the curve through the cube, which holds all points;
  /// their fourth numbers are anything.
  void sort(std::span<const Vec4> points, const MortonCube& cube,
            base::BigVector<std::uint32_t>& order);

 private:
  void sort_by_digits();
  void sort_rest();
  std::size_t sort_run_at(std::size_t k);

  base::BigVector<std::uint64_t> keys_, scratch_;  ///< upper 32 bits of a code, index
};

}  // namespace macula::lights
