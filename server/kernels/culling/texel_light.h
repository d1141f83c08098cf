// Indirect light asked at the texels of a map, shared among neighbours there, and brought back to
// every cell of the view. Mode Fast only.
#pragma once

#include "server/kernels/culling/texel_map.h"
#include "server/kernels/ray/config.h"

namespace macula::kernels::culling {

/// Adds to `light` what the virtual lights of `config` bring at each cell of a view, per unit of
/// reflectance. Texels take the classes of lights side by side and share with those within `reach`
/// that lie on one surface; cells mix the four texels around them that do. Cells without any are
/// asked themselves.
/// `surfaces`: the view's depth and normals, of the same frame.
FrameReport add_texel_light(const FrameRequest& request, std::size_t view, const TexelMap& map,
                            const SceneFrame& scene, const ray::Config& config, int reach,
                            const ViewBuffers& surfaces, TileScheduler& scheduler,
                            Plane<Rgb>& light);

}  // namespace macula::kernels::culling
