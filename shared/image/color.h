// Colours: Rgb is linear Rec.709 radiance, Rgb8 is display-encoded (sRGB), 8 bits a channel.
#pragma once

#include <cstdint>

#include "shared/math/vec.h"

namespace macula::image {

using Rgb = Vec3;

struct Rgb8 {
  std::uint8_t r = 0, g = 0, b = 0;
  friend bool operator==(const Rgb8&, const Rgb8&) = default;
};
static_assert(sizeof(Rgb8) == 3);

/// Relative luminance, Rec.709 weights.
inline float luminance(const Rgb& c) { return 0.2126F * c.x + 0.7152F * c.y + 0.0722F * c.z; }

}  // namespace macula::image

namespace macula {
using image::Rgb;
using image::Rgb8;
}  // namespace macula
