// An orthonormal frame around a unit normal, continuous everywhere except across the plane z = 0,
// where its handedness fix flips; no branch, no failure at the poles. Source: Duff, Burgess,
// Christensen, Hery, Kensler, Liani, Villemin, "Building an Orthonormal Basis, Revisited", JCGT
// 6(1) 2017.
#pragma once

#include <cmath>

#include "shared/math/vec.h"

namespace macula::sampling {

/// Columns (tangent, bitangent, normal), right-handed: `frame * local` is a direction in the
/// frame's surroundings for a local one with the normal along +Z. `normal` is unit.
inline Mat3 frame_from_normal(const Vec3& normal) {
  const float sign = std::copysign(1.0F, normal.z);
  const float a = -1.0F / (sign + normal.z);
  const float b = normal.x * normal.y * a;
  return Mat3(Vec3{1.0F + sign * normal.x * normal.x * a, sign * b, -sign * normal.x},
              Vec3{b, sign + normal.y * normal.y * a, -normal.y}, normal);
}

}  // namespace macula::sampling
