// What every kernel does alike with its output planes.
#pragma once

#include "server/kernels/kernel.h"

namespace macula::kernels {

/// The planes that `wanted` names, of this size; the others are emptied.
void prepare_planes(ViewBuffers& planes, unsigned wanted, int width, int height);
/// Gives every view of `out` the planes that are wanted, at its grid's size; the others are
/// emptied. Motion is left to kernels that keep a history. Keeps memory of equal size.
void prepare_buffers(std::span<const View> views, FrameBuffers& out);
/// Writes the wanted rate of every cell where kRate is set.
scheduling::Outcome fill_rate(const FrameRequest& request, TileScheduler& scheduler,
                              FrameBuffers& out);

}  // namespace macula::kernels
