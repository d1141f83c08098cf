#include "client/reprojection/resolve.h"

#include <algorithm>

namespace macula::reprojection {
namespace {

/// Cell index and weight of the next cell, of a coordinate clamped to [0, size - 1].
struct Tap {
  int first, second;
  float weight;
};
inline Tap tap_at(float coordinate, int size) {
  const float last = static_cast<float>(size - 1);
  const float clamped = std::min(std::max(coordinate, 0.0F), last);
  const int first = static_cast<int>(clamped);
  return {first, std::min(first + 1, size - 1), clamped - static_cast<float>(first)};
}

struct Weights {
  float w00, w10, w01, w11;
  std::uint8_t mix(std::uint8_t c00, std::uint8_t c10, std::uint8_t c01, std::uint8_t c11) const {
    const float value = w00 * static_cast<float>(c00) + w10 * static_cast<float>(c10) +
                        w01 * static_cast<float>(c01) + w11 * static_cast<float>(c11);
    return static_cast<std::uint8_t>(value + 0.5F);  // weights sum to 1: within [0, 255]
  }
};

inline Rgb8 color_at(const Fragment& fragment, const image::Plane<Rgb8>& source) {
  const Tap x = tap_at(fragment.u, source.width()), y = tap_at(fragment.v, source.height());
  const float right = x.weight, lower = y.weight;
  const Weights weights{(1.0F - right) * (1.0F - lower), right * (1.0F - lower),
                        (1.0F - right) * lower, right * lower};
  const Rgb8 &c00 = source(x.first, y.first), &c10 = source(x.second, y.first);
  const Rgb8 &c01 = source(x.first, y.second), &c11 = source(x.second, y.second);
  return {weights.mix(c00.r, c10.r, c01.r, c11.r), weights.mix(c00.g, c10.g, c01.g, c11.g),
          weights.mix(c00.b, c10.b, c01.b, c11.b)};
}

}  // namespace

void resolve_colors(const Fragments& fragments, const image::Plane<Rgb8>& source,
                    image::Plane<Rgb8>& out) {
  out.resize(fragments.width(), fragments.height());
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    const Fragment& fragment = fragments.data()[i];
    if (fragment.drawn()) out.data()[i] = color_at(fragment, source);
  }
}

}  // namespace macula::reprojection
