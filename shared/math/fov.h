// An asymmetric field of view: what one eye's display shows.
#pragma once

#include "shared/math/vec.h"
#include "shared/units/angle.h"

namespace macula::math {

/// Signed half-angles as OpenXR has them: left and down are usually negative.
struct Fov {
  Radians left, right, up, down;

  /// Edges on the tangent plane of frames.h: y points down, so top = -tan(up).
  DVec2 tangent_min() const { return {std::tan(left.value()), -std::tan(up.value())}; }
  DVec2 tangent_max() const { return {std::tan(right.value()), -std::tan(down.value())}; }
};

/// Symmetric about the axis, square pixels: the horizontal angle follows from the aspect.
Fov symmetric_fov(Radians vertical, double width_over_height);
/// Every half-angle finite, inside (-90, 90) degrees, left < right and down < up.
bool is_valid(const Fov& fov);

}  // namespace macula::math

namespace macula {
using math::Fov;
}
