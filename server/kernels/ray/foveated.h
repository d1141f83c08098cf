// The foveated method of kernel `ray`, frame by frame: support, reprojection, mask, samples, cache
// update, merge. README.md names the equations. Same picture for any number of threads.
#pragma once

#include "server/kernels/kernel.h"
#include "server/kernels/ray/config.h"

namespace macula::kernels::ray {

/// `out` has been prepared. Remembers in `history`; a record of another kernel is replaced.
FrameReport render_foveated(const FrameRequest& request, const SceneFrame& scene,
                            const Config& config, History& history, TileScheduler& scheduler,
                            FrameBuffers& out);

}  // namespace macula::kernels::ray
