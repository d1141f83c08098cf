// `macula-bench compare`: every metric of shared/metrics on two pictures, in one row
//   mse rmse relmse psnr_db ssim flip flip_weighted_median ew_psnr_db gp_psnr_db
// mse, rmse and relmse are in linear light, the rest on display values. EXR pictures are brought to
// display values by `exposure_ev`, a clip at 1 and the sRGB curve. When both are EXR, flip is
// HDR-FLIP. ssim is that of the BT.601 luma, border of 5 px left out (shared/metrics/ssim.h).
#pragma once

#include <optional>
#include <string>

#include "shared/base/result.h"
#include "shared/math/vec.h"
#include "shared/metrics/flip.h"

namespace macula::bench {

struct CompareOptions {
  std::string reference, test;  ///< PNG (8-bit sRGB) or EXR (linear), same size
  double pixels_per_degree = metrics::kDefaultPixelsPerDegree;  ///< (0, 1000]
  std::optional<DVec2> gaze_px;  ///< from the top-left corner; none: the middle
  double exposure_ev = 0.0;      ///< of EXR pictures, for the display metrics
  std::string json;              ///< report; empty: none
  std::string map;               ///< FLIP error in false colour, PNG; empty: none
};

/// Prints the row. Missing, unreadable or different-sized pictures are bad input.
Result<void> run_compare(const CompareOptions& options);

}  // namespace macula::bench
