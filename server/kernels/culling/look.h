// What the eye looks at, before anything is lit: a coarse picture of the surfaces and of how much
// their light matters, and shading points drawn from it.
#pragma once

#include <vector>

#include "server/kernels/culling/contribution.h"
#include "server/kernels/culling/keep_lights.h"

namespace macula::kernels::culling {

struct Look {
  std::vector<View> views;  ///< of every guide_step-th cell
  FrameBuffers surfaces;
  std::vector<Plane<float>> importance;  ///< by view, [0, 1]
  /// By view: how likely a cell is drawn, by its importance and its area.
  std::vector<Plane<float>> weights;
  FrameReport report;
};

/// Brightness as `memory` has it.
Look look(const FrameRequest& request, const SceneFrame& scene, const Config& config,
          const CullingHistory& memory, TileScheduler& scheduler);

/// `count` shading points over all views, each view's share by its importance. `frame`: others in
/// the next one.
std::vector<ShadingPoint> draw_points(const Look& seen, const Config& config, int count,
                                      std::uint64_t seed, std::uint64_t frame);

}  // namespace macula::kernels::culling
