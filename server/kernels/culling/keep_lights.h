// From a scene and what its viewers see to the virtual lights that a frame is lit with.
#pragma once

#include <vector>

#include "server/kernels/culling/culling_kernel.h"
#include "server/kernels/culling/smoothing.h"
#include "server/reconstruction/picture_memory.h"

namespace macula::kernels::culling {

/// Of one session. Lights are told apart by their place in the list, which stays while none comes
/// or goes.
struct CullingHistory final : HistoryRecord {
  std::vector<ViewMemory> views;
  std::vector<reconstruction::PictureMemory> pictures;  ///< by view; none: none is remembered
  scene::ScenePose objects;    ///< where they were; empty: nothing moves, or nothing was seen yet
  std::vector<float> brought;  ///< by each light to shading points, or its square: mean over frames
  int brought_frames = 0;      ///< that it is the mean of
  std::size_t brought_cells = 0;   ///< of the last frame's views
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
