// Kernel `culling`: one bounce of indirect light by virtual point lights, of which only those are
// kept that matter where the eye looks. Radiance is linear Rec.709, depth in meters. Holds
// configuration only. README.md in this folder has the method in one screen.
#pragma once

#include "server/kernels/culling/config.h"
#include "server/kernels/kernel.h"

namespace macula::kernels::culling {

/// Where a frame's time went, wall milliseconds of the calling thread.
struct StageTimes {
  double lights_ms = 0.0;  ///< making virtual lights
  double importance_ms = 0.0, contribution_ms = 0.0, culling_ms = 0.0;
  double shading_ms = 0.0;  ///< surfaces, direct light and that of the kept lights
  double post_ms = 0.0;     ///< sharing and remembering

  StageTimes& operator+=(const StageTimes& other) {
    lights_ms += other.lights_ms, importance_ms += other.importance_ms;
    contribution_ms += other.contribution_ms, culling_ms += other.culling_ms;
    shading_ms += other.shading_ms, post_ms += other.post_ms;
    return *this;
  }
  StageTimes& operator/=(double by) {
    lights_ms /= by, importance_ms /= by, contribution_ms /= by;
    culling_ms /= by, shading_ms /= by, post_ms /= by;
    return *this;
  }
};

/// What a frame found before it shaded anything.
struct KeptLights {
  std::vector<lights::VirtualPointLight>
      lights;            ///< weights in their fluxes, along the Morton curve
  std::size_t made = 0;  ///< virtual lights before culling
  double least_m = 0.0;  ///< shortest distance that counts
  /// Route::Cuts: nodes of every cell's cut, by view, and the most of any.
  std::vector<image::Plane<std::uint16_t>> cut_nodes;
  int most_nodes = 0;
  FrameReport report;
  StageTimes stages;
};

class CullingKernel final : public Kernel {
 public:
  explicit CullingKernel(const Config& config) : config_(config) {}

  FrameReport render(const FrameRequest& request, const SceneFrame& scene, History& history,
                     TileScheduler& scheduler, FrameBuffers& out) const override;
  /// With all virtual lights: points of no frame have no importance.
  void shade(std::span<const SurfacePoint> points, const SceneFrame& scene,
             TileScheduler& scheduler, std::span<Rgb> out) const override;

 private:
  Config config_;
};

}  // namespace macula::kernels::culling
