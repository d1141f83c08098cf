// Retinal speed: how fast what every cell shows crosses the eye's retina, less what the gaze's own
// turning takes from it: the velocity feature of the paper's FSFM. Instances move as wholes;
// changes of shape are not told. World, meters, seconds.
// Source: Shi et al., "Foveated Stochastic Lightcuts", section 4.
#pragma once

#include <span>
#include <vector>

#include "server/kernels/kernel.h"
#include "server/kernels/lightcuts/surfaces.h"
#include "server/scene/animation.h"

namespace macula::kernels::lightcuts {

using image::Plane;

/// From one frame to the next.
struct Passage {
  const View& then;
  const View& now;
  std::span<const scene::InstanceMotion> motions;  ///< ascending by instance
  double seconds = 0.0;                            ///< > 0
};

/// Degrees a second of every cell of `now`; where nothing was hit, of what is infinitely far.
/// `surface_id`: of the same cells.
Plane<float> retinal_speed(const Passage& passage, const ViewSurfaces& surfaces,
                           const Plane<std::uint32_t>& surface_id, TileScheduler& scheduler);

}  // namespace macula::kernels::lightcuts
