// Kernel `lightcuts`: direct light of very many lights by cuts of a light tree. Radiance is linear
// Rec.709, depth in meters. Holds configuration only; keeps no history. README.md in this folder
// has the method in one screen.
#pragma once

#include <vector>

#include "server/kernels/kernel.h"
#include "server/kernels/lightcuts/config.h"

namespace macula::kernels::lightcuts {

/// Where a frame with cuts of perceived sizes sends its samples, by view.
struct LightPlan {
  std::vector<PerceptionMap> maps;
  std::vector<Plane<std::uint16_t>> cut_nodes;
  FrameReport report;  ///< of the rays that it took
};
/// From the surfaces of every cell and a low-resolution picture whose random numbers the frame's
/// own do not depend on: the sizes of cuts leave the frame's mean unchanged.
LightPlan plan_lights(const FrameRequest& request, const SceneFrame& scene, const Config& config,
                      TileScheduler& scheduler);

class LightcutsKernel final : public Kernel {
 public:
  explicit LightcutsKernel(const Config& config) : config_(config) {}

  FrameReport render(const FrameRequest& request, const SceneFrame& scene, History& history,
                     TileScheduler& scheduler, FrameBuffers& out) const override;
  void shade(std::span<const SurfacePoint> points, const SceneFrame& scene,
             TileScheduler& scheduler, std::span<Rgb> out) const override;

 private:
  Config config_;
};

}  // namespace macula::kernels::lightcuts
