// Settings of kernel `lightcuts`: kernel `ray`'s tiles, with the lights of a cut in place of every
// light. README.md in this folder has the method in one screen.
#pragma once

#include "server/kernels/lightcuts/perception_map.h"
#include "server/kernels/ray/config.h"

namespace macula::kernels::lightcuts {

/// Uniform: Config::ray.area_light_samples nodes in every cut. Perceived: as many as the eye would
/// see the difference, by a perception map; mode Fast only.
enum class CutSizes { Uniform, Perceived };

/// Where the light of a node of a cut of perceived size comes from. Walks: a walk of its own.
/// LowResolution: also the low-resolution picture's draws (the paper's Algorithm 2, corrected).
enum class LightSource { Walks, LowResolution };

struct Config {
  ray::Config ray;
  CutSizes sizes = CutSizes::Uniform;
  // ---- Perceived ----
  PerceptionConfig perception;
  int most_nodes = 48;     ///< of a cut where the map is 1, >= 1
  int low_resolution = 8;  ///< cells of the grid along a side of one of the low-resolution picture
  int low_nodes = 16;      ///< of the cuts there; 0: no such picture, the map goes without contrast
  LightSource source = LightSource::LowResolution;
  int kept_nodes = 48;      ///< of the cuts whose draws are kept for others; LowResolution
  double mean_nodes = 0.0;  ///< > 0: the map is scaled so that this is the mean of all cuts
};

/// KernelOptions::area_light_samples is the most nodes of a cut, over all lights that have a place.
inline Config make_config(const KernelOptions& options) {
  Config config;
  config.ray = ray::make_config(options);
  config.ray.lights = ray::LightChoice::ByCut;
  if (options.light_share == LightShare::Perceived) config.sizes = CutSizes::Perceived;
  return config;
}

}  // namespace macula::kernels::lightcuts
