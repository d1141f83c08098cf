// From a scene and what its viewers see to the virtual lights that a frame is lit with.
#pragma once

#include <vector>

#include "server/kernels/culling/culling_kernel.h"
#include "server/kernels/culling/smoothing.h"

namespace macula::kernels::culling {

/// Of one session. Lights are told apart by their place in the list, which stays while none comes
/// or goes.
struct CullingHistory final : HistoryRecord {
  std::vector<ViewMemory> views;
  std::vector<float> visible;  ///< share of each light that points received, over the last frames
  std::size_t made = 0, kept = 0;  ///< virtual lights of the last frame
  StageTimes stages;               ///< of the last frame
};

/// Makes the virtual lights, tells the importance of every guide_step-th cell, draws shading
/// points, asks what each light contributes there, and culls. Mode Exact looks at nothing
/// remembered and draws lights anew every frame.
KeptLights keep_lights(const FrameRequest& request, const SceneFrame& scene, const Config& config,
                       CullingHistory& memory, TileScheduler& scheduler);

/// All virtual lights of a scene, along the Morton curve.
KeptLights all_lights(const SceneFrame& scene, const Config& config, std::uint64_t seed,
                      TileScheduler& scheduler);

}  // namespace macula::kernels::culling
