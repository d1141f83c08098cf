// Kernel `brute`: the reference every other kernel is held to. One ray at a time, independent
// random numbers, every light, no cleverness: its value is that it shares no estimator, no batching
// and no sample sequence with the others (only the scene's tables and the BSDF, which have tests of
// their own). Exact in both modes; slow.
#pragma once

#include "server/kernels/kernel.h"
#include "server/kernels/options.h"

namespace macula::kernels {

class BruteKernel final : public Kernel {
 public:
  explicit BruteKernel(const KernelOptions& options) : options_(options) {}

  FrameReport render(const FrameRequest& request, const SceneFrame& scene, History& history,
                     TileScheduler& scheduler, FrameBuffers& out) const override;
  void shade(std::span<const SurfacePoint> points, const SceneFrame& scene,
             TileScheduler& scheduler, std::span<Rgb> out) const override;

 private:
  KernelOptions options_;
};

}  // namespace macula::kernels
