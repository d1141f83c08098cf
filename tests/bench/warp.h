// `macula-bench warp`: what the client's warp costs on this machine, by its own clock. A rendered
// frame with its guard band is warped to a pose 1.2 cm and 2.5 degrees away (what 50 ms of vigorous
// motion make), again and again. Rows
//   scene grid method width_px height_px cells filled_pct cpu_ms wall_ms wall_both_ms psnr_db
// cpu_ms and wall_ms are one eye's on one thread, wall_both_ms two eyes' on two threads at once;
// the least of the repetitions. psnr_db is against the first method of the table.
// Methods: every_cell (no blocks), full (what the client does), bilinear (full, but for its
// filter), grid (blocks to half a pixel, bilinear), rotation.
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.h"

namespace macula::bench {

struct WarpCostOptions {
  std::vector<std::string> scenes{"posts", "atrium", "city"};
  std::vector<std::string> grids{"uniform", "foveal"};
  std::vector<std::string> methods;  ///< empty: all
  int width_px = 1440, height_px = 1600;
  double vertical_fov_deg = 90.0, guard_deg = 8.0;
  int repetitions = 7;
  int threads = 0;  ///< of the renderer
  std::string json;
};

/// Prints the table. Errors name the option or scene at fault.
Result<void> run_warp_cost(const WarpCostOptions& options);

}  // namespace macula::bench
