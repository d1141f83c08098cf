// LightPlan: where a frame with cuts of perceived sizes sends its samples. Never from what the
// frame itself draws, so that its mean stays that of any other plan.
#pragma once

#include <span>
#include <vector>

#include "server/kernels/kernel.h"
#include "server/kernels/lightcuts/config.h"

namespace macula::kernels::lightcuts {

struct LightPlan {
  std::vector<PerceptionMap> maps;              ///< a view each
  std::vector<Plane<std::uint16_t>> cut_nodes;  ///< of every cell's cut
  FrameReport report;                           ///< of the rays that it took
};
/// From normals and albedo of every cell in `surfaces`, their speeds (a plane a view, or none at
/// all: everything rests), and a low-resolution picture whose random numbers are its own.
LightPlan plan_lights(const FrameRequest& request, const SceneFrame& scene, const Config& config,
                      const FrameBuffers& surfaces, std::span<const Plane<float>> speeds,
                      TileScheduler& scheduler);
/// The same, tracing the surfaces first; everything rests.
LightPlan plan_lights(const FrameRequest& request, const SceneFrame& scene, const Config& config,
                      TileScheduler& scheduler);

}  // namespace macula::kernels::lightcuts
