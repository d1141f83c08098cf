// How wrong a server's frames are, as they are made: a few pixels of the display, more of them
// where the eye resolves more, are rendered twice by a method without error but noise. What a frame
// shows there, less the one, times itself less the other, has the frame's squared error for its
// mean: noise, blur, what is remembered wrongly and detail below every cell. Costs some 6,000
// samples. Pure but for the rendering.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "server/kernels/kernel.h"
#include "shared/foveation/pixel_grid.h"

namespace macula::session {

/// A frame for one eye, as its display shows it.
struct FrameToJudge {
  kernels::View view;          ///< where it is seen from, and the grid that `shown` lies on
  foveation::Display display;  ///< at full scale
  /// Counted from one to the next, so that they look at other pixels.
  std::uint64_t judgement = 0, seed = 1;
};

/// Display-linear squared errors, averaged over the view's solid angle by the density of samples
/// that the eye resolves (metrics::acuity_weight). Sums of several are the estimate of all.
struct SpotError {
  double squares = 0.0;  ///< may be negative: its mean is not
  double weight = 0.0;

  SpotError& operator+=(const SpotError& more) {
    squares += more.squares, weight += more.weight;
    return *this;
  }
  double mean_square() const { return weight > 0.0 ? squares / weight : 0.0; }
  double rmse() const { return std::sqrt(std::max(mean_square(), 0.0)); }
};

/// `reference`: a kernel without error but noise, kernels::make_reference. `shown`: the frame, its
/// size is the view's grid's. Which pixels are looked at depends on judgement and seed. nullopt:
/// stopped by the scheduler's token.
std::optional<SpotError> spot_error(const kernels::Kernel& reference,
                                    const kernels::SceneFrame& scene, const FrameToJudge& frame,
                                    const image::Plane<Rgb>& shown,
                                    kernels::TileScheduler& scheduler);

}  // namespace macula::session
