// A view's picture over frames, in which every cell is sampled at other places: smooth, and calm
// where the head moves. Mode Fast. `reconstruction/picture_memory.h` has the method.
#pragma once

#include "server/kernels/kernel.h"
#include "server/reconstruction/picture_memory.h"

namespace macula::kernels::culling {

/// Joins buffers.radiance, linear, with what `last` remembers (none: nothing). `most_frames` >= 1.
/// What `movers` tells to have moved is found where it was. `memory` is for the next frame. Reads
/// depth_m.
scheduling::Outcome steady_picture(const View& view, const reconstruction::PictureMemory* last,
                                   const reconstruction::Movers& movers, int most_frames,
                                   TileScheduler& scheduler, ViewBuffers& buffers,
                                   reconstruction::PictureMemory& memory);

}  // namespace macula::kernels::culling
