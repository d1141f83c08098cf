// Guides: what other kernels want to know of a picture before they light it.
#pragma once

#include <span>
#include <vector>

#include "server/kernels/kernel.h"
#include "server/kernels/ray/config.h"

namespace macula::kernels::ray {

/// Views whose grids have every n-th edge of these and the last: cells n x n as large. n >= 1.
std::vector<View> thinned(std::span<const View> views, int n);

/// A primary ray a cell through fixed places, nothing is lit; the planes that are wanted. The
/// report grows by its rays.
FrameBuffers trace_surfaces(const FrameRequest& request, const SceneFrame& scene,
                            const Config& config, unsigned wanted, TileScheduler& scheduler,
                            FrameReport& report);

/// samples_wanted_row(): rate of `model` times the area of each cell in nominal pixels, by view: a
/// cell that stands for many pixels deserves what all of them do. On request.views, whose grids may
/// be thinner than those of request.foveation; gazes and nominal pixels are that one's.
FoveationMap acuity_map(const FrameRequest& request, const foveation::RateModel& model);

}  // namespace macula::kernels::ray
