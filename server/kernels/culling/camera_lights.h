// Virtual lights from where the eye looks: how the paper that kernel `culling` follows describes
// its rival, foveated instant radiosity (Wang et al. 2020): "generates VPLs from the camera", kept
// by visibility and place, whatever light there is. Assumed, as the rival's own text is not at
// hand: one bounce; lights lie where cosine-distributed rays from the shading points end; each
// stands for the inverse of the density with which the points send rays there (Segovia et al.,
// "Bidirectional Instant Radiosity", 2006), asked by a ray from every point; the same random
// numbers in every frame, so that lights stay. What no shading point sees is lost.
#pragma once

#include <vector>

#include "server/kernels/culling/contribution.h"

namespace macula::kernels::culling {

struct CameraLights {
  std::vector<lights::VirtualPointLight> lights;  ///< only those that shine
  std::uint64_t rays = 0;
  bool stopped = false;
};

/// From `count` rays. Deterministic for any number of threads.
CameraLights camera_lights(const SceneFrame& scene, std::span<const ShadingPoint> points, int count,
                           const Config& config, scheduling::TileScheduler& scheduler);

}  // namespace macula::kernels::culling
