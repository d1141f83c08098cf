// Morton codes of many points, in vectors. Internal to the room.
#pragma once

#include <cstdint>
#include <span>

#include "shared/math/vec.h"

namespace macula::lights {

inline constexpr int kMortonBits = 21;  ///< an axis

struct MortonCube {
  DVec3 corner{0.0};             ///< the lowest one
  double cells_per_meter = 0.0;  ///< 0 where all points coincide
};

/// codes[i]: morton_code of the cell that points[i] lies in; the far faces belong to the last
/// cells.
void morton_codes(std::span<const Vec3> points, const MortonCube& cube,
                  std::span<std::uint64_t> codes);

}  // namespace macula::lights
