// Light of the placed lights by reservoirs: a point draws a light of every node of its cut, traces
// rays to a few of them (RIS), and combines them by pairwise MIS with what it, and another point
// near by, kept of the last frame. World, meters; a point's light does not depend on tiles and
// threads.
#pragma once

#include "server/kernels/lightcuts/config.h"
#include "server/kernels/lightcuts/cut_light.h"
#include "server/kernels/lightcuts/light_history.h"

namespace macula::kernels::lightcuts {

/// Adds to slots as add_cut_light, and writes the tile's reservoirs. `last`: none in a first frame.
/// Beyond five degrees from `view`'s gaze a second neighbour is asked where memory is short.
void add_reservoir_light(const SceneFrame& scene, const SurfaceTile& tile, const CutPlan& plan,
                         const ReservoirConfig& config, const KeptView* last, const View& view,
                         CutWork& work, Plane<Reservoir>& reservoirs, std::span<Rgb> slots);

}  // namespace macula::kernels::lightcuts
