// The silhouette band: the cells of a picture behind which something may come into sight while the
// eye stays near the place the picture was taken from. A step of inverse depth between neighbours
// opens by radius (1/z_near - 1/z_far) on the tangent plane when the eye moves by radius; the near
// side's cells within that distance hide what is then seen. Pure. Source: REPROJECTION B3 step 3.
#pragma once

#include <cstdint>

#include "server/scheduling/tile_scheduler.h"
#include "shared/foveation/pixel_grid.h"
#include "shared/image/plane.h"

namespace macula::disocclusion {

/// 1 where a cell belongs to the band, else 0; the size of its grid.
using Band = image::Plane<std::uint8_t>;

/// `depth_m`: view depth, +infinity = nothing there; what is no positive number counts as nothing.
/// `radius_m` > 0: how far the eye may have moved. Steps that open by less than half a cell do not
/// count; cells that lie less than that in front of the far side do not hide it.
void find_band(const image::Plane<float>& depth_m, const PixelGrid& grid, double radius_m,
               scheduling::TileScheduler& scheduler, Band& out);

/// The inverse depth (1/m) in front of which a surface of inverse depth `near` at cell (x, y) lies
/// by half a cell's parallax: what may come into sight lies beyond. 0: only infinity does;
/// negative: nothing does.
float far_limit(const PixelGrid& grid, int x, int y, float near, double radius_m);

}  // namespace macula::disocclusion
