// The little drawing that reports need: false colour, tiles side by side, a cross at the gaze.
#pragma once

#include <vector>

#include "shared/image/color.h"
#include "shared/image/plane.h"

namespace macula::image {

/// Perceptually ordered dark-blue -> yellow ramp for t in [0, 1]; clamped; NaN is magenta.
Rgb8 false_color(float t);
/// `low` maps to 0, `high` to 1.
Plane<Rgb8> false_color(const Plane<float>& values, float low, float high);
/// Pictures in rows of `columns`, scaled down (box filter) to `tile_width_px`, 4 px apart.
Plane<Rgb8> contact_sheet(const std::vector<Plane<Rgb8>>& pictures, int columns, int tile_width_px);
void draw_cross(Plane<Rgb8>& picture, Pixel centre, int arm_px, Rgb8 color);
Plane<Rgb8> downscale(const Plane<Rgb8>& picture, int width_px);

}  // namespace macula::image
