// LightPlan: where a frame with cuts of perceived sizes sends its samples. Never from what the
// frame itself draws, so that its mean stays that of any other plan.
#pragma once

#include <span>
#include <vector>

#include "server/kernels/kernel.h"
#include "server/kernels/lightcuts/config.h"
#include "server/kernels/lightcuts/surfaces.h"

namespace macula::kernels::lightcuts {

struct LightPlan {
  std::vector<PerceptionMap> maps;              ///< a view each
  std::vector<Plane<std::uint16_t>> cut_nodes;  ///< of every cell's cut
  FrameReport report;                           ///< of the rays that it took
};
/// The views with a pixel for every low_resolution-th cell of either axis.
struct LowViews {
  std::vector<View> views;
  std::vector<ViewSurfaces> surfaces;
  FrameBuffers out;  ///< radiance: what shines by itself
  FrameReport report;
};
LowViews trace_low_views(const FrameRequest& request, const SceneFrame& scene, const Config& config,
                         TileScheduler& scheduler);

/// From normals and albedo of every cell in `surfaces`, their speeds (a plane a view, or none at
/// all: everything rests), and a low-resolution picture whose random numbers are its own: of the
/// surfaces in `low`, whose radiance becomes the picture's.
LightPlan plan_lights(const FrameRequest& request, const SceneFrame& scene, const Config& config,
                      const FrameBuffers& surfaces, std::span<const Plane<float>> speeds,
                      LowViews& low, TileScheduler& scheduler);
/// The same, tracing the surfaces first; everything rests.
LightPlan plan_lights(const FrameRequest& request, const SceneFrame& scene, const Config& config,
                      TileScheduler& scheduler);

}  // namespace macula::kernels::lightcuts
