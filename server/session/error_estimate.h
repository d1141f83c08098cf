// How wrong a server's frames are, from themselves: two pictures of the same moment that share a
// frame's cells between them, do not coincide and are drawn apart. Three pictures whose errors are
// independent tell each one's error by how far they lie from each other, also where the frame
// remembers more than the two; what errors they share, a quality ladder knows from its
// measurements. Costs about one more frame. Pure but for the rendering.
#pragma once

#include <optional>

#include "server/kernels/kernel.h"
#include "shared/foveation/pixel_grid.h"

namespace macula::session {

/// A frame as prepare_views makes it, for one eye.
struct FrameToJudge {
  kernels::View view;          ///< where it is seen from; its own grid is where they are compared
  foveation::Display display;  ///< at full scale
  double scale = 1.0;          ///< of the frame
  foveation::RateModel model;
  foveation::FovealGridOptions grid;
  std::uint64_t frame = 0, seed = 1;
};

/// With `shown` the frame, a and b the two half-sample pictures, which start without history:
/// sqrt((|shown - a|^2 + |shown - b|^2 - |a - b|^2) / 2), display-linear RMS: the part of the
/// frame's error that the two do not share ("three-cornered hat", Gray and Allan 1974). Averaged
/// over the view's solid angle by the density of samples that the eye resolves
/// (metrics::acuity_weight). shown.size() == the view's grid's. nullopt: stopped by the scheduler's
/// token.
std::optional<double> half_picture_difference(const kernels::Kernel& kernel,
                                              const kernels::SceneFrame& scene,
                                              const FrameToJudge& frame,
                                              const image::Plane<Rgb>& shown,
                                              kernels::TileScheduler& scheduler);

}  // namespace macula::session
