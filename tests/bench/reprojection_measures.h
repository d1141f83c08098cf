// What `macula-bench reprojection` measures on one pose: the shown picture against the expected
// one, and the error bound of a source's cells against where the renderer says their points are.
#pragma once

#include <vector>

#include "client/reprojection/warp.h"
#include "tests/bench/reprojection_methods.h"
#include "tests/bench/reprojection_setting.h"

namespace macula::bench {

/// `share` in [0, 1] of at least one value; linear between them.
double percentile(std::vector<double> values, double share);

/// What the poses of one row gave.
struct Samples {
  std::vector<double> psnr_db, f10_psnr_db, bound_p95_px, true_p95_px, violations, bytes,
      hidden_bytes_pct, gp_psnr_db, flip, holes_pct, outside_pct, error_filled_pct,
      error_silhouette_pct, hidden_cells_pct, hidden_cpu_pct, cpu_ms, turn_deg, offset_cm;
};

/// Warps `source` to the pose of `expected` and measures the outcome, which is left in `shown`.
void add_sample(const SourcePicture& source, const SourcePicture& expected,
                const foveation::Display& display, const Method& method,
                reprojection::Warper& warper, image::Plane<Rgb8>& shown, Samples& samples);

/// The bound of a source's cells against where the renderer says their points are: nine in each.
struct BoundCheck {
  double bound_p95_px = 0.0, true_p95_px = 0.0, violations = 0.0;
};
BoundCheck check_bound(const SourcePicture& source, const image::Plane<float>& fine_inverse_depth,
                       const Pose& to, const foveation::Display& display,
                       const reprojection::WarpOptions& options);

/// Grey: four times the root mean square error of each pixel.
image::Plane<Rgb8> error_picture(const image::Plane<Rgb8>& shown,
                                 const image::Plane<Rgb8>& expected);

}  // namespace macula::bench
