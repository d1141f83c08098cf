// One frame with cuts of perceived sizes: surfaces once, the plan, the low-resolution draws, light.
#pragma once

#include "server/kernels/lightcuts/light_plan.h"

namespace macula::kernels::lightcuts {

/// One primary sample a cell; Config::sizes Perceived.
FrameReport render_deferred(const FrameRequest& request, const SceneFrame& scene,
                            const Config& config, TileScheduler& scheduler, FrameBuffers& out);

}  // namespace macula::kernels::lightcuts
