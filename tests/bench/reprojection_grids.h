// The grids of `macula-bench reprojection`, and what is cut from them or split.
#pragma once

#include "tests/bench/reprojection_setting.h"

namespace macula::bench {

/// The part of a picture that lies on the display's own raster.
SourcePicture without_guard(const SourcePicture& picture, const foveation::Display& display);
/// The same cells, half a cell to the right and down.
PixelGrid shifted(PixelGrid grid);
/// The server's own grid around a gaze straight ahead.
PixelGrid foveal_grid(const foveation::Display& display, double scale, Degrees guard,
                      const foveation::RateModel& model);
/// Three cells for each, along both axes.
PixelGrid three_times_finer(const PixelGrid& grid);

}  // namespace macula::bench
