// Morton codes in vectors. Internal to the room.
#pragma once

#include "server/lights/morton.h"

namespace macula::lights {

inline constexpr int kMortonBits = 21;  ///< an axis
inline constexpr int kKeyBits = 32;     ///< the upper bits of a code that a key holds
inline constexpr int kLowerBits = 3 * kMortonBits - kKeyBits;

/// keys[i]: the upper kKeyBits of the morton_code of the cell that point i lies in, then i; the far
/// faces belong to the last cells.
void morton_keys(std::span<const Vec4> points, const MortonCube& cube,
                 std::span<std::uint64_t> keys);
/// The whole code of one point.
std::uint64_t morton_code(const Vec4& point, const MortonCube& cube);

}  // namespace macula::lights
