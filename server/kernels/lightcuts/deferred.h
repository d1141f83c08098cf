// One frame: surfaces once, the plan, the low-resolution draws, light, and its smoothing.
#pragma once

#include "server/kernels/lightcuts/light_plan.h"

namespace macula::kernels::lightcuts {

/// One primary sample a cell. Cuts of equal sizes are walked. Reservoirs keep a record in
/// `history`.
FrameReport render_deferred(const FrameRequest& request, const SceneFrame& scene,
                            const Config& config, History& history, TileScheduler& scheduler,
                            FrameBuffers& out);

}  // namespace macula::kernels::lightcuts
