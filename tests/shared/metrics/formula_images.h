// Pictures given by formulas, so that known answers need no files.
#pragma once

#include <cmath>
#include <cstdint>

#include "shared/image/color.h"
#include "shared/image/plane.h"

namespace macula::test {

using image::Plane;

/// In [0, 1): a 32-bit integer hash, top 24 bits.
inline float rnd(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352dU;
  x ^= x >> 15;
  x *= 0x846ca68bU;
  x ^= x >> 16;
  return static_cast<float>(x >> 8) * 0x1p-24F;
}

inline constexpr int kFormulaWidth = 64, kFormulaHeight = 48;

/// of(x, y) -> pixel.
template <class Of>
auto picture(int width, int height, Of of) {
  Plane<decltype(of(0, 0))> result(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) result(x, y) = of(x, y);
  }
  return result;
}
template <class Of>
auto picture(Of of) {
  return picture(kFormulaWidth, kFormulaHeight, of);
}

inline Plane<Rgb> constant(const Rgb& color) {
  return picture([&](int, int) { return color; });
}
inline Plane<Rgb> constant(float grey) {
  return constant(Rgb{grey});
}

inline Rgb ramp_at(int x, int y) {
  return {static_cast<float>(x) / 63.0F, static_cast<float>(y) / 47.0F,
          static_cast<float>((x ^ y) & 7) / 7.0F};
}
inline float checker_at(int x, int y) {
  return static_cast<float>((x / 4 + y / 4) & 1);
}

/// 8-bit texture values in [68, 188].
inline int texture_at(int x, int y) {
  return 128 + static_cast<int>(std::lround(60.0 * std::sin(0.7 * x) * std::cos(0.5 * y)));
}

}  // namespace macula::test
