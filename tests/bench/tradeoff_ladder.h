// A quality ladder from measured rows: the configurations of foveal grids that no other beats in
// both time and error over all scenes, numbered 0 to 10 by the logarithm of their cost.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "shared/base/result.h"
#include "tests/bench/report.h"

namespace macula::bench {

struct LadderStep {
  std::string config;
  double cost_ms = 0.0;              ///< geometric mean over the scenes, like the rest
  double rmse = 0.0;                 ///< rmse_ew
  double per_half_difference = 0.0;  ///< rmse over half_difference
};
/// Of one kernel's rows, cheapest first; configurations that lack a scene are left out.
std::vector<LadderStep> ladder_steps(std::span<const Fields> rows);

/// FOLDER/KERNEL.toml as macula-server reads it (server/app/ladder_file.h); `command` and `where`
/// say how the numbers came about.
Result<void> write_ladder(const std::string& folder, const std::string& kernel,
                          std::span<const Fields> rows, const std::string& command);

}  // namespace macula::bench
