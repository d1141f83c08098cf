// Where a frame's bits go: an offset to the quantiser of every macroblock, from the gaze and the
// rate model. Finest where the model asks for every sample, coarser by the logarithm of what it
// asks for elsewhere, so that equal bytes sharpen the fovea and the outer field pays.
#pragma once

#include <vector>

#include "shared/foveation/gaze.h"
#include "shared/foveation/pixel_grid.h"
#include "shared/foveation/rate.h"

namespace macula::codec {

struct FovealQuantiser {
  double finest = -5.0;   ///< offset where the rate is 1
  double coarsest = 5.0;  ///< offset at the grid's least rate; no macroblock is beyond either
};

/// Row by row of the grid's macroblocks (16 x 16 cells, rounded up), each by its nearest cell to
/// the gaze. Never falls as eccentricity grows; a model that is uniform gets the middle everywhere.
std::vector<float> quantiser_offsets(const PixelGrid& grid, const Gaze& gaze,
                                     const foveation::RateModel& model,
                                     const FovealQuantiser& range = {});

}  // namespace macula::codec
