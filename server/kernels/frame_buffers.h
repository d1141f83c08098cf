// What a kernel writes. Radiance and depth always; the other planes when their flag is set.
// kLight is made by kernel `ray` only; others leave its planes black.
#pragma once

#include <cstdint>
#include <vector>

#include "shared/image/color.h"
#include "shared/image/plane.h"

namespace macula::kernels {

enum PlaneFlag : unsigned {
  kSurfaceId = 1U << 0,
  kNormal = 1U << 1,
  kAlbedo = 1U << 2,
  kMotion = 1U << 3,
  kRate = 1U << 4,
  kVariance = 1U << 5,
  kSamples = 1U << 6,
  kSteps = 1U << 7,  ///< kernels that march distance fields only
  kLight = 1U << 8,  ///< both light and reflectance
};

struct ViewBuffers {
  image::Plane<Rgb> radiance;              ///< linear Rec.709
  image::Plane<float> depth_m;             ///< -z in view space; +infinity: nothing hit
  image::Plane<std::uint32_t> surface_id;  ///< instance index + 1; 0: nothing hit
  image::Plane<Vec3> normal;               ///< unit, world, shading normal
  image::Plane<Rgb> albedo;
  image::Plane<Vec2> motion;     ///< cells since the last frame
  image::Plane<float> rate;      ///< samples per nominal display pixel that were wanted
  image::Plane<float> variance;  ///< of the mean luminance
  image::Plane<float> samples;   ///< samples taken in the cell
  image::Plane<float> steps;     ///< evaluations of the field a sample
  /// The part of radiance that chance estimates (area and ambient light), per unit of reflectance.
  image::Plane<Rgb> light;
  image::Plane<Rgb> reflectance;  ///< directional, of the same samples; 0 where nothing was hit
};

struct FrameBuffers {
  unsigned wanted = 0;  ///< PlaneFlag bits, set by the caller
  std::vector<ViewBuffers> views;
};

}  // namespace macula::kernels
