// How wrong a server's frames are, from themselves: two pictures of the same moment that share a
// frame's cells between them, do not coincide and are drawn apart. Where they
// differ, both are wrong; a quality ladder knows from its measurements how a frame's error goes
// with that difference. Costs about one more frame. Pure but for the rendering.
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

/// RMS difference of the two half-sample pictures over sqrt(2), display-linear: the part of the
/// error of either that the other does not share. Averaged over the view's solid angle by the
/// density of samples that the eye resolves (metrics::acuity_weight). Both start without history.
/// nullopt: stopped by the scheduler's token.
std::optional<double> half_picture_difference(const kernels::Kernel& kernel,
                                              const kernels::SceneFrame& scene,
                                              const FrameToJudge& frame,
                                              kernels::TileScheduler& scheduler);

}  // namespace macula::session
