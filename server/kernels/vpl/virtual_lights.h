// Virtual point lights of a scene: the light of its lamps after one diffuse reflection, from traced
// reflective shadow maps (Dachsbacher and Stamminger 2005; rays in place of rasterised maps). World
// space, meters, linear Rec.709. A pure function of scene and config: the same bits for any number
// of threads; equal seeds keep the virtual lights of a moving lamp together from frame to frame.
// Left out: what an environment, the ambient light and mirror-like lobes add.
#pragma once

#include <vector>

#include "server/kernels/scene_frame.h"
#include "server/lights/virtual_point_light.h"
#include "server/scheduling/tile_scheduler.h"

namespace macula::kernels::vpl {

struct Config {
  int side = 64;  ///< side^2 rays for every punctual light, >= 0
  int emissive_side =
      64;  ///< side^2 rays for all emissive triangles together, by their power; >= 0
  shading::MaterialModel model = shading::MaterialModel::AsInScene;
  std::uint64_t seed = 0;
  /// Moves the rays of every light together, in the unit square that they fill evenly, wrapping at
  /// its ends: by less than 1 / side, they land beside where they did.
  Vec2 shift{0.0F};
};

/// `rays` rays in all, or fewer: as many for every punctual light, and for all emissive triangles.
Config shared_out(const SceneFrame& scene, std::size_t rays);

struct VirtualLights {
  /// In the order of lights, emissive triangles last, and of their rays; only those that shine.
  std::vector<lights::VirtualPointLight> lights;
  std::size_t rays = 0;  ///< traced
  bool stopped = false;  ///< the stop token fired: there are no lights
};

/// One ray, at most one virtual light: where it first meets a surface, with the diffuse part of
/// what is reflected there of the ray's flux, so that fluxes sum to the light that lamps send and
/// surfaces reflect diffusely. Where light arrives under a shading normal, flux is what the
/// shading room reflects of it: the diffuse share times the cosine there over the geometric one.
VirtualLights make_virtual_lights(const SceneFrame& scene, const Config& config,
                                  scheduling::TileScheduler& scheduler);

}  // namespace macula::kernels::vpl
