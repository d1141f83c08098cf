// PlacedLightTable: lights that have a place, as vectors read them: a row a light, with all that
// its light is made of, and in short what a tree is built from. World space, meters, linear
// Rec.709. Plain values.
#pragma once

#include <cstdint>

#include "shared/base/big_vector.h"
#include "shared/math/vec.h"

namespace macula::lights {

/// No: every light shines everywhere, cones need not be asked.
enum class Oriented { No, Yes };

/// One cache line: trees and receivers read them in no order.
struct alignas(64) PlacedLightRow {
  Vec3 position{0.0F};
  Vec3 edge1{0.0F};     ///< to a triangle's second vertex; cosines of a lamp's outer and inner cone
                        ///< and 0; of a virtual light its span and 0, 0
  Vec3 edge2{0.0F};     ///< to a triangle's third vertex
  Vec3 normal{0.0F};    ///< unit, the side it shines to, or the way a lamp shines
  Vec3 emission{0.0F};  ///< mean radiance, W/(sr m^2), or intensity along `normal`, W/sr
  float area = 0.0F;    ///< m^2; 0: a lamp; kVirtual: a virtual light

  static constexpr std::size_t kFloats = 16;
  static constexpr float kVirtual = -1.0F;
};
static_assert(sizeof(PlacedLightRow) == PlacedLightRow::kFloats * sizeof(float));

struct PlacedLightTable {
  base::BigVector<PlacedLightRow> rows;
  base::BigVector<std::uint32_t> triangle;  ///< index into LightList::emissive() + 1; 0: none

  // ---- for trees ----
  /// By light: the centre of its box; largest intensity in any direction, W/sr. A quarter of a row:
  /// lights that shine everywhere are put into a tree by this alone.
  base::BigVector<Vec4> places;
  Vec3 low{0.0F}, high{0.0F};  ///< the box about the centres; anything without a light
  float brightest = 0.0F;      ///< the largest intensity, W/sr
  Oriented oriented = Oriented::No;

  std::size_t size() const { return rows.size(); }
  const float* floats() const { return &rows.data()->position.x; }
};

}  // namespace macula::lights
