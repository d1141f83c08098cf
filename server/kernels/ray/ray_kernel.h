// Kernel `ray`: primary rays on the grid, every light by shadow rays, ambient occlusion, one BSDF,
// textures. Radiance is linear Rec.709, depth in meters. Holds configuration only; one kernel may
// render for many sessions at once. README.md in this folder has the rules in one screen.
#pragma once

#include <string>
#include <vector>

#include "server/kernels/kernel.h"
#include "server/kernels/ray/config.h"

namespace macula::kernels::ray {

/// What mode Fast does not leave unbiased.
std::vector<std::string> shortcuts(const SceneFrame& scene);

class RayKernel final : public Kernel {
 public:
  explicit RayKernel(const Config& config) : config_(config) {}

  FrameReport render(const FrameRequest& request, const SceneFrame& scene, History& history,
                     TileScheduler& scheduler, FrameBuffers& out) const override;
  void shade(std::span<const SurfacePoint> points, const SceneFrame& scene,
             TileScheduler& scheduler, std::span<Rgb> out) const override;
  const Config& config() const { return config_; }

 private:
  Config config_;
};

}  // namespace macula::kernels::ray
