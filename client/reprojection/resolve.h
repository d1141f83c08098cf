// From places in the source grid to colours. Internal to this room; one thread.
#pragma once

#include "client/reprojection/raster.h"
#include "shared/image/color.h"

namespace macula::reprojection {

/// Bilinear between cell centres, clamped at the grid's edge; black where nothing is drawn.
void resolve_colors(const Fragments& fragments, const image::Plane<Rgb8>& source,
                    image::Plane<Rgb8>& out);

}  // namespace macula::reprojection
