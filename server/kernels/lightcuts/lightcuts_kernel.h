// Kernel `lightcuts`: direct light of very many lights by cuts of a light tree. Radiance is linear
// Rec.709, depth in meters. Holds configuration only; keeps no history. README.md in this folder
// has the method in one screen.
#pragma once

#include "server/kernels/kernel.h"
#include "server/kernels/lightcuts/config.h"
#include "server/kernels/lightcuts/light_plan.h"

namespace macula::kernels::lightcuts {

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
