// LightBounds: what a light tree knows of one light: where it can be, how strong it is at most and
// where to it shines. Everything is conservative: light never leaves the box or the cone. World
// space, meters. Source: Conty Estevez and Kulla 2018 (the cone); names theta_o, theta_e from
// there.
#pragma once

#include "shared/math/vec.h"

namespace macula::lights {

/// One cache line: trees read them in no order.
struct alignas(64) LightBounds {
  Vec3 centre{0.0F}, half{0.0F};  ///< box: centre +- half
  /// Axis of the cone of directions that get the full intensity, unit; its half-angle is theta_o.
  Vec3 axis{0.0F, 0.0F, 1.0F};
  float half_sine = 1.0F;  ///< sin(theta_o / 2), exact also for narrow cones; 1: every direction
  /// cos(theta_e): beyond the cone light falls at least as fast as the cosine of the angle to it,
  /// and is 0 from theta_e on.
  float cos_emission = 0.0F;
  /// Luminance of the largest radiant intensity in any direction, W/sr: a triangle's along its
  /// normal, of its mean emission. Finite, >= 0.
  double intensity = 0.0;

  bool shines_everywhere() const { return half_sine >= 1.0F; }
};

}  // namespace macula::lights
