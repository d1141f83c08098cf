// Settings of kernel `lightcuts`: kernel `ray`'s tiles, with the lights of a cut in place of every
// light. README.md in this folder has the method in one screen.
#pragma once

#include <algorithm>

#include "server/kernels/lightcuts/perception_map.h"
#include "server/kernels/ray/config.h"

namespace macula::kernels::lightcuts {

/// Uniform: Config::ray.area_light_samples nodes in every cut. Perceived: as many as the eye would
/// see the difference, by a perception map; mode Fast only.
enum class CutSizes { Uniform, Perceived };

/// Where the light of a node of a cut of perceived size comes from. Walks: a walk of its own.
/// LowResolution: also the low-resolution picture's draws (the paper's Algorithm 2, corrected).
/// Reservoirs: both as candidates for a few rays, and what the last frame's rays found.
enum class LightSource { Walks, LowResolution, Reservoirs };

/// Rays of a cell whose cut may have so many nodes: one for `nodes_a_ray` of them, within bounds.
struct RayShare {
  int nodes_a_ray = 1, least = 1, most = 1024;  ///< >= 1; `least` gives way to `most`
  int of(int nodes) const {
    return std::clamp((nodes + nodes_a_ray - 1) / nodes_a_ray, std::min(least, most), most);
  }
};

struct ReservoirConfig {
  /// To a point's own draws. Small cuts draw by what lights bring: leaving draws out gains nothing.
  RayShare rays{2, 2, 16};
  float most_confidence = 20.0F;  ///< frames that memory counts for at most
  /// Rays that find out whether a neighbour sees a light at all. Without them the last frame's
  /// point is taken to see what this one sees: where it does not, some light is lost.
  bool traces_neighbours = false;
  /// What is remembered has the colour of all the light that it was chosen from, not of the one
  /// light that was chosen: its luminance alone has the right mean.
  bool blends_colours = true;
};

/// Yes: light over reflectance is joined with what earlier frames found on the same surfaces and
/// smoothed along them, further where the eye sees less. One sample a cell, mode Fast only.
enum class Denoise { No, Yes };

/// Yes: a second view takes over what the first found where it sees the same surface (OtherEye),
/// and lights the rest. Mode Fast, one sample a cell.
enum class StereoReuse { No, Yes };

/// Yes: glossy and specular surfaces also reflect what they see, over one bounce (gloss.h), where
/// the scene has any. One sample a cell.
enum class Gloss { No, Yes };

struct Config {
  ray::Config ray;
  CutSizes sizes = CutSizes::Uniform;
  // ---- Perceived ----
  PerceptionConfig perception;
  int most_nodes = 48;     ///< of a cut where the map is 1, >= 1
  int least_nodes = 2;     ///< of any cut, >= 1; most_nodes where that is less
  int low_resolution = 8;  ///< cells of the grid along a side of one of the low-resolution picture
  int low_nodes = 8;       ///< of the cuts there; 0: no such picture, the map goes without contrast
  LightSource source = LightSource::LowResolution;
  int kept_nodes = 48;  ///< of the cuts whose draws are kept for others; not Walks
  ReservoirConfig reservoirs;
  RayShare gloss_rays{2, 3, 16};  ///< of a glossy cell, along its lobe
  // ---- any size ----
  Denoise denoise = Denoise::No;
  StereoReuse stereo = StereoReuse::No;
  Gloss gloss = Gloss::No;
  double mean_nodes = 0.0;  ///< > 0: the map is scaled so that this is the mean of all cuts
};

/// KernelOptions::area_light_samples is the most nodes of a cut, over all lights that have a place.
/// What chance leaves of so few is smoothed.
inline Config make_config(const KernelOptions& options) {
  Config config;
  config.ray = ray::make_config(options);
  config.ray.lights = ray::LightChoice::ByCut;
  if (options.mode == Mode::Fast) config.denoise = Denoise::Yes;
  if (options.mode == Mode::Fast) config.stereo = StereoReuse::Yes;
  if (options.light_share == LightShare::Perceived) {
    config.sizes = CutSizes::Perceived;
    config.source = LightSource::Reservoirs;
  }
  return config;
}

}  // namespace macula::kernels::lightcuts
