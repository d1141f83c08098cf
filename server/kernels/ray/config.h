// Settings of kernel `ray`.
#pragma once

#include <span>

#include "server/kernels/options.h"
#include "server/kernels/ray/foveated_config.h"
#include "server/lights/virtual_point_light.h"
#include "server/shading/material_table.h"

namespace macula::kernels::ray {

/// Where the samples of a cell lie: at fixed points, or at random ones within equal shares of it.
enum class Placement { Fixed, Jittered };

/// Every: all punctual lights, and emissive triangles drawn by power. ByCut: the lights of a cut of
/// the light tree (kernel `lightcuts`). None: surfaces only, for the planes; nothing is lit.
enum class LightChoice { Every, ByCut, None };

/// Virtual point lights of one frame (kernel `culling`); none: no indirect light.
struct VirtualLightShare {
  std::span<const lights::VirtualPointLight> lights;  ///< must outlive the frame
  /// A square number >= 1: every point asks the lights of one class, index modulo classes, and counts
  /// them so many times. Classes lie side by side in n x n cells and change from frame to frame.
  int classes = 1;
  float least_m = 0.0F;  ///< distances count as at least this, which takes light from corners; >= 0
};

struct Config {
  Mode mode = Mode::Fast;
  int samples_per_cell = 1;  ///< primary rays a cell, >= 1
  Placement placement = Placement::Jittered;
  /// Shadow rays per primary ray: to emissive triangles, or to all lights by cut; >= 1.
  int area_light_samples = 8;
  int ambient_samples = 4;      ///< occlusion rays per primary ray; 0: no ambient term
  int environment_samples = 4;  ///< shadow rays to the environment per primary ray, >= 1
  shading::MaterialModel materials = shading::MaterialModel::AsInScene;
  LightChoice lights = LightChoice::Every;
  VirtualLightShare virtual_lights;
  FoveatedConfig foveated;  ///< mode Fast only
};

inline Config make_config(const KernelOptions& options) {
  FoveatedConfig foveated;
  foveated.method = options.reuse == Reuse::EarlierFrames ? Method::Foveated : Method::Full;
  return {
      options.mode,
      options.samples_per_cell,
      options.jitter ? Placement::Jittered : Placement::Fixed,
      options.area_light_samples,
      options.ambient_samples,
      options.environment_samples,
      options.lambert_only ? shading::MaterialModel::Lambert : shading::MaterialModel::AsInScene,
      LightChoice::Every,
      {},
      foveated};
}

}  // namespace macula::kernels::ray
