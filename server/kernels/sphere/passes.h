// The passes of one view: every cell, or low level, mask, middle level, important cells, the rest.
// Paper 2023, section 3.2, passes 1 to 5.
#pragma once

#include "server/kernels/sphere/keep.h"
#include "server/kernels/sphere/view_context.h"

namespace macula::kernels::sphere {

/// Renders one view into `out`. `last`: its last frame, or null; `now` is what the next frame gets
/// (left empty where nothing is to be kept). A stopped scheduler leaves `out` incomplete and sets
/// report.stopped.
FrameReport render_view(const ViewContext& context, const ViewHistory* last,
                        TileScheduler& scheduler, ViewBuffers& out, ViewHistory& now);

}  // namespace macula::kernels::sphere
