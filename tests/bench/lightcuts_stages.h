// Stages of a frame of kernel lightcuts, apart from each other, on the points that a frame's
// primary rays meet: CPU milliseconds of one thread.
#pragma once

#include "tests/bench/lightcuts_setting.h"

namespace macula::bench {

struct LightcutsStages {
  double tree_ms = 0.0;    ///< the list of lights and the tree over them, made anew
  double cut_ms = 0.0;     ///< a cut a point
  double sample_ms = 0.0;  ///< a walk from each of its nodes down to a light
  double glossy_ms = 0.0;  ///< the rays of glossy points, and light where they arrive
};

/// `cut_nodes`: of each pixel's cut. One tile in `every` is measured and stands for the others, by
/// points. tree_ms is not a number for scenes with virtual lights: the
/// tree there holds more than the scene lists.
LightcutsStages stages_of(const LightcutsSetting& setting, const kernels::lightcuts::Config& config,
                          const Plane<std::uint16_t>& cut_nodes, int every,
                          scheduling::TileScheduler& scheduler);

/// What the stages of a frame with cuts of perceived sizes make, to be looked at.
struct LightcutsStagePlanes {
  Plane<Rgb>
      low_picture;  ///< what contrast is seen in: a pixel for low_resolution x low_resolution
  kernels::lightcuts::PerceptionMap maps;
  Plane<std::uint16_t> cut_nodes;
  Plane<float> taken;  ///< share of a pixel's nodes whose light a low pixel had drawn, [0, 1]
};
LightcutsStagePlanes stage_planes_of(const LightcutsSetting& setting,
                                     const kernels::lightcuts::Config& config,
                                     scheduling::TileScheduler& scheduler);

}  // namespace macula::bench
