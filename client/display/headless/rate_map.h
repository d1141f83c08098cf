// The foveation map as a picture: how densely a frame's grid samples the view, in false colour,
// with a cross at the gaze. Density is nominal display pixels per cell area: yellow where a cell is
// no larger than a nominal pixel, dark blue at 1/64 and below, black outside the grid.
#pragma once

#include "shared/foveation/pixel_grid.h"
#include "shared/image/color.h"
#include "shared/image/plane.h"

namespace macula::display {

/// Cells per nominal pixel of the cell under `tangent`; 0 outside the grid.
float cell_density(const PixelGrid& grid, const foveation::Display& display, const Vec2& tangent);

/// At the display's own size and frustum.
image::Plane<Rgb8> draw_rate_map(const PixelGrid& grid, const foveation::Display& display,
                                 const Gaze& gaze);

}  // namespace macula::display
