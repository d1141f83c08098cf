// Lighting of a batch of points: punctual lights, emissive triangles, ambient occlusion. Every term
// is one stream of shadow rays over the whole batch. A point's radiance is summed in a fixed order
// and depends on that point alone, never on its neighbours in the batch.
#pragma once

#include <cstdint>
#include <span>

#include "server/kernels/ray/config.h"
#include "server/kernels/scene_frame.h"
#include "server/sampling/sample.h"

namespace macula::kernels::ray {

/// A point to be lit, seen from where its reflector's frame says.
struct LitPoint {
  DVec3 position{0.0};  ///< world, meters
  shading::Reflector reflector;
  sampling::SampleKey key;   ///< identity of its cell's random numbers
  std::uint32_t sample = 0;  ///< which primary sample of the cell it is
};

struct LightingWork {
  std::uint64_t shadow_rays = 0;
  double trace_ms = 0.0;  ///< time inside visibility queries
};

class Lighting {
 public:
  /// Refers to both; they must outlive it.
  Lighting(const SceneFrame& scene, const Config& config) : scene_(scene), config_(config) {}

  /// Adds the light every point reflects to its eye to radiance[i]. At most
  /// visibility::kStreamCapacity points; radiance.size() == points.size().
  void add(std::span<const LitPoint> points, std::span<Rgb> radiance, LightingWork& work) const;

 private:
  void add_punctual(const scene::Light& light, std::span<const LitPoint> points,
                    std::span<Rgb> radiance, LightingWork& work) const;
  void add_area(int k, std::span<const LitPoint> points, std::span<Rgb> radiance,
                LightingWork& work) const;
  void add_ambient(int k, std::span<const LitPoint> points, std::span<Rgb> radiance,
                   LightingWork& work) const;

  const SceneFrame& scene_;
  const Config& config_;
};

}  // namespace macula::kernels::ray
