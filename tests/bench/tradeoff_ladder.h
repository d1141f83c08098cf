// A quality ladder from measured rows: the configurations of foveal grids that no other beats in
// both time and what is seen, error and flicker together, over all scenes, numbered 0 to 10 by the
// logarithm of their cost.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "shared/base/result.h"
#include "tests/bench/report.h"

namespace macula::bench {

struct LadderStep {
  std::string config;
  double cost_ms = 0.0;  ///< geometric mean over the scenes, like the rest
  double rmse = 0.0;     ///< rmse_ew
};
/// Of one kernel's rows, cheapest first; configurations that lack a scene are left out.
std::vector<LadderStep> ladder_steps(std::span<const Fields> rows);

/// How well a server would know the errors of this scene's frames, at the steps of a ladder made
/// from all other scenes.
struct EstimateCheck {
  int steps = 0;
  double kendall_tau = 0.0;      ///< of the order of steps whose true errors differ by 5 %
  double share_within_30 = 0.0;  ///< of steps whose estimate is within 30 % of the error
  double worst_factor = 1.0;     ///< estimate over error or its inverse
};
EstimateCheck check_estimates(std::span<const Fields> rows, const std::string& scene);

/// (concordant - discordant) / pairs, of those whose first values differ by more than `share` of
/// the smaller: nearer ones have no order that could be kept. Positive values; 1 where there is no
/// pair.
double kendall_tau(std::span<const double> a, std::span<const double> b, double share = 0.0);

/// FOLDER/KERNEL.toml as macula-server reads it (server/app/ladder_file.h); `command` and `where`
/// say how the numbers came about.
Result<void> write_ladder(const std::string& folder, const std::string& kernel,
                          std::span<const Fields> rows, const std::string& command);

}  // namespace macula::bench
