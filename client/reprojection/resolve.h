// From places in the source grid to colours. Internal to this room; one thread.
#pragma once

#include "client/reprojection/raster.h"
#include "client/reprojection/warp.h"
#include "shared/image/color.h"

namespace macula::reprojection {

/// Colours between cell centres; the grid's outermost cells go on beyond its edge; black where
/// nothing is drawn. At a cell's centre the result is that cell's colour to the bit, whatever the
/// filter.
void resolve_colors(const Fragments& fragments, const image::Plane<Rgb8>& source,
                    WarpOptions::Filter filter, image::Plane<Rgb8>& out);

}  // namespace macula::reprojection
