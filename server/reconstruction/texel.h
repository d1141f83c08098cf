// Texel: a colour as pictures that are filtered store it.
#pragma once

#include "shared/image/color.h"

namespace macula::reconstruction {

/// Four numbers that are filtered together; one load of a vector register.
struct alignas(16) Texel {
  float r = 0.0F, g = 0.0F, b = 0.0F, unused = 0.0F;

  Texel() = default;
  explicit Texel(const Rgb& c) : r(c.x), g(c.y), b(c.z) {}
  Rgb rgb() const { return {r, g, b}; }
};

}  // namespace macula::reconstruction
