// What no triangle reached. A display pixel between drawn ones, sideways or upright, was uncovered
// by the camera's offset: it is filled from the farther end of the shorter way across, because what
// comes into sight is behind what moved away. Everything else lies beyond the frame. One thread.
#pragma once

#include "client/reprojection/raster.h"
#include "client/reprojection/warp.h"

namespace macula::reprojection {

/// Marks every pixel; under FillFartherSide holes in `fragments` receive their neighbour's
/// fragment.
void classify_and_fill(Fragments& fragments, WarpOptions::Holes holes,
                       image::Plane<Coverage>& coverage);

}  // namespace macula::reprojection
