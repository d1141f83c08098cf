// Contribution of virtual lights to the shading points (section 3.3): what they bring there, hidden
// as a few traced rays say. It only steers which lights are kept, so its noise never biases a
// picture.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/kernels/culling/config.h"
#include "server/scheduling/tile_scheduler.h"

namespace macula::kernels::culling {

/// World, meters.
struct ShadingPoint {
  Vec3 position{0.0F};
  Vec3 normal{0.0F};        ///< unit, towards the eye
  float distance_m = 0.0F;  ///< from the eye: how far rounding reaches
  float albedo = 0.0F;      ///< luminance of the reflectance
};

struct Contributions {
  /// By light, >= 0: the mean over the points of what would arrive, or of its square.
  std::vector<float> unhidden;
  /// By light, in [0, 1]: the share of it that traced points receive and one more, unhidden; 1
  /// without rays.
  std::vector<float> visible;
  std::uint64_t rays = 0;
  bool stopped = false;
};

/// Each light asks config.visibility_rays of the points, others than its neighbours in the list,
/// and others in the next frame. `least_m`: as lights::arriving.
Contributions contributions(const SceneFrame& scene,
                            std::span<const lights::VirtualPointLight> lights,
                            std::span<const ShadingPoint> points, const Config& config,
                            double least_m, std::uint64_t frame,
                            scheduling::TileScheduler& scheduler);

}  // namespace macula::kernels::culling
