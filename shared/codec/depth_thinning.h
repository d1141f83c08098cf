// Depth at a fraction of its resolution, for slow links: one cell of every divisor x divisor block,
// and back. Internal to this room; depth.h is the door. Thread-safe.
#pragma once

#include "shared/image/plane.h"

namespace macula::codec {

/// Samples along an axis of `cells`.
constexpr int thinned(int cells, int divisor) {
  return (cells + divisor - 1) / divisor;
}

/// The middle cell of every block.
image::Plane<float> thin(const image::Plane<float>& whole, int divisor);

/// Inverse depth between samples: bilinear where its four neighbours lie on one surface (inverse
/// depth is affine on planes), the nearest sample where they do not.
void spread(const image::Plane<float>& samples, int divisor, image::Plane<float>& whole);

}  // namespace macula::codec
