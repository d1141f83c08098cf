// `macula-bench maps`: bytes that different foveation maps need for the same picture, to the eye.
// One eye is rendered on each map's grid (3x3 fixed samples a cell), coded as JPEG at many
// qualities, decoded, warped to its own pose on the display, and judged by GP-PSNR against the
// renderer on the display's raster. Rows
//   scene gaze map cells_pct gp_psnr_best_db target_db bytes_at_target bytes_of_ours
// target_db is what a uniform grid of a quarter of the pixels reaches, coded at quality 85 (or what
// the weakest map reaches at all); bytes are read off each map's own curve there.
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.h"

namespace macula::bench {

struct MapsOptions {
  std::vector<std::string> scenes{"posts", "atrium", "city"};
  std::vector<std::string> gazes{"0,0", "15,-8"};  ///< yaw,pitch in degrees
  /// Ours: full rate to the first angle, falling to the last number at the second; degrees.
  std::vector<std::string> ramps{"10,35,0.05", "8,30,0.05", "3,28,0.12", "2,22,0.12"};
  int width_px = 1440, height_px = 1600;
  double vertical_fov_deg = 96.0;
  int threads = 0;
  std::string json;
};
/// One scene, a gaze, half the pixels a side.
void make_quick(MapsOptions& options);

Result<void> run_maps(const MapsOptions& options);

}  // namespace macula::bench
