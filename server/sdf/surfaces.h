// From where rays stopped to the surfaces they hit: the crossing itself, its normal and material.
// Inside server/sdf.
#pragma once

#include "server/sdf/lane_march.h"

namespace macula::sdf {

/// Crossing, normal and material of every hit lane into hits[id]. A ray that crosses the surface
/// hits it there; one that only comes within the hit distance hits where it does so first. Both are
/// the same bits wherever near it the ray stopped.
MarchWork find_surfaces(const MarchLimits& limits, TraceScratch& scratch, std::vector<Hit>& hits);

}  // namespace macula::sdf
