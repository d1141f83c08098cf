// Kernel `sphere`: foveated sphere tracing of distance fields (Polychronakis, Koulieris, Mania
// 2023, corrected). Only for scenes that are a distance field. Radiance is linear Rec.709, depth in
// meters. Holds configuration only; keeps its history in the caller's History. README.md in this
// folder has the rules in one screen.
#pragma once

#include "server/kernels/kernel.h"
#include "server/kernels/sphere/config.h"

namespace macula::kernels::sphere {

/// Exact: every cell traced, no history, lights and sky occluded. Fast: foveated, nothing occluded.
Config make_config(const KernelOptions& options);

class SphereKernel final : public Kernel {
 public:
  explicit SphereKernel(const Config& config);

  FrameReport render(const FrameRequest& request, const SceneFrame& scene, History& history,
                     TileScheduler& scheduler, FrameBuffers& out) const override;
  void shade(std::span<const SurfacePoint> points, const SceneFrame& scene,
             TileScheduler& scheduler, std::span<Rgb> out) const override;
  const Config& config() const { return config_; }

 private:
  Config config_;
};

}  // namespace macula::kernels::sphere
