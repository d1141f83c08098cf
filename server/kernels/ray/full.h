// Every cell of every view, every frame: what kernels do that remember nothing.
#pragma once

#include <cstdint>
#include <span>

#include "server/kernels/parcels.h"
#include "server/kernels/ray/config.h"

namespace macula::kernels::ray {

/// Into prepared buffers. `cut_nodes`: a plane a view, as ViewContext::cut_nodes; or none.
/// `audience`: who reads them where ranks share the frame.
FrameReport render_full(const FrameRequest& request, const SceneFrame& scene, const Config& config,
                        TileScheduler& scheduler, FrameBuffers& out, Audience audience,
                        std::span<const image::Plane<std::uint16_t>> cut_nodes = {});

}  // namespace macula::kernels::ray
