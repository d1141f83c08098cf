// Settings of kernel `ray`.
#pragma once

#include <span>

#include "server/kernels/options.h"
#include "server/kernels/ray/foveated_config.h"
#include "server/lights/virtual_light_table.h"
#include "server/shading/material_table.h"

namespace macula::kernels::ray {

/// Where the samples of a cell lie: at fixed points, or at random ones within equal shares of it.
enum class Placement { Fixed, Jittered };

/// Every: all punctual lights, and emissive triangles drawn by power. ByCut: the lights of a cut of
/// the light tree (kernel `lightcuts`). None: surfaces only, for the planes; nothing lights them
/// but virtual lights, where there are some.
enum class LightChoice { Every, ByCut, None };

/// Textures of mode Fast: as wide as a sample's footprint, or at points, as in mode Exact.
enum class Footprints { Filtered, Points };

/// Whether what hides a virtual light is asked by a ray, or nothing hides it.
enum class VirtualShadows { Traced, None };

/// What becomes of light from nearer than VirtualLightTable::least_m that is more than from there:
/// lost, or brought back by a short ray a point (bias compensation, Kollig and Keller 2004).
enum class NearLight { Lost, Bounced };

/// Virtual point lights of one frame (kernel `culling`); none: no indirect light. What is pointed
/// to must outlive the frame.
struct VirtualLightShare {
  /// Every point asks the lights of one class and counts them as often as there are classes, a
  /// square number: classes lie side by side in n x n cells and change from frame to frame.
  const lights::VirtualLightTable* lights = nullptr;
  /// Shadow rays of a point: to so many lights of its class, drawn by what they would bring; 0: to
  /// every one that brings anything. With a tree: most nodes of a cut where a cell has no number
  /// of its own, >= 1.
  int asked = 0;
  /// Over the same lights, one class: points ask a light of every node of their cut; or none.
  const lights::LightTree* tree = nullptr;
  VirtualShadows shadows = VirtualShadows::Traced;
  NearLight near_light = NearLight::Lost;

  bool any() const { return lights != nullptr && !lights->empty(); }
};

struct Config {
  Mode mode = Mode::Fast;
  int samples_per_cell = 1;  ///< primary rays a cell, >= 1
  Placement placement = Placement::Jittered;
  /// Shadow rays per primary ray: to emissive triangles, or to all lights by cut; >= 1.
  int area_light_samples = 8;
  int ambient_samples = 4;      ///< occlusion rays per primary ray; 0: no ambient term
  int environment_samples = 4;  ///< shadow rays to it per primary ray; 0: no environment
  shading::MaterialModel materials = shading::MaterialModel::AsInScene;
  LightChoice lights = LightChoice::Every;
  Footprints footprints = Footprints::Filtered;
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
      Footprints::Filtered,
      {},
      foveated};
}

}  // namespace macula::kernels::ray
