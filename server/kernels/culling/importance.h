// Importance map (section 3.2): how much the light that a cell receives matters to the eye. Pure.
#pragma once

#include "server/kernels/culling/config.h"
#include "shared/image/plane.h"

namespace macula::kernels::culling {

using image::Plane;

/// Planes of one size, by cell.
struct ImportanceInputs {
  const Plane<float>& acuity;   ///< p_a, [0, 1]
  const Plane<float>& depth_m;  ///< view depth; +infinity: nothing there
  const Plane<Vec3>& normal;    ///< unit
  const Plane<Rgb>& albedo;     ///< linear, [0, 1]
  /// Tone-mapped brightness of indirect light, [0, 1]; infinite: not known; empty: nowhere is.
  const Plane<float>& brightness;
};

/// P = max(p_a, p_g) p_b in [0, 1]; 0 where nothing was hit. p_g: a neighbour's normal or color
/// differs, or the depth is off the plane through both neighbours in a row or column (1/z is affine
/// over planes, so slanted ones have no edges).
Plane<float> make_importance(const ImportanceInputs& inputs, const ImportanceConfig& config);

/// Raises weights where acuity is full until they have `share` of the sum, if they have less and
/// any at all. share < 1.
void focus(const Plane<float>& acuity, float share, Plane<float>& weights);

/// 255 sqrt((2 + r) dr^2 + 4 dg^2 + (3 - r) db^2), r the mean red, of sRGB-encoded values
/// ("redmean").
float color_distance(const Rgb& a, const Rgb& b);

}  // namespace macula::kernels::culling
