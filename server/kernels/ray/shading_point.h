// From a point on a surface to what its lighting needs: material, textures, normals, emission.
#pragma once

#include <span>

#include "server/kernels/kernel.h"
#include "server/kernels/ray/lighting.h"

namespace macula::kernels::ray {

/// Slants beyond 1 : 16 no longer widen a sample's footprint.
inline constexpr float kLeastSlant = 1.0F / 16.0F;

struct ShadingRequest {
  shading::Surface surface;
  Vec3 to_eye{0.0F};  ///< unit, world
  float uv_per_meter = 0.0F;
  float footprint_m = 0.0F;  ///< width of the sample across the ray; 0: textures unfiltered

  /// Side of the square of texture space the sample stands for. It grows with the surface's slant
  /// along one axis only; the square root shares that between blur and aliasing.
  float footprint_uv() const;
  shading::SampleFootprint footprint() const { return {footprint_uv(), footprint_m, to_eye}; }
};

struct ShadedPoint {
  Rgb emission{0.0F};  ///< towards the eye: front faces only
  shading::Reflector reflector;
};

ShadedPoint shade_point(const ShadingRequest& request, const SceneFrame& scene,
                        const Config& config);

/// Radiance towards the eye of at most visibility::kStreamCapacity points.
void shade_batch(std::span<const SurfacePoint> points, const SceneFrame& scene,
                 const Config& config, const Lighting& lighting, std::span<Rgb> out);

}  // namespace macula::kernels::ray
