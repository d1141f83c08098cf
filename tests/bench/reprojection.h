// `macula-bench reprojection`: what each way of hiding latency is worth. A frame rendered for the
// head of `latency_ms` ago is warped to the head of now and compared with the renderer at exactly
// that pose: 60 degrees, 600 pixels a side, 12 degrees of guard band, 3x3 fixed samples on both
// sides. Rows
//   scene trace latency_ms method codec foveated rate_model source_scale material layers poses
//   psnr_db psnr_p10_db f10_psnr_db gp_psnr_db flip holes_pct outside_guard_pct error_filled_pct
//   error_silhouette_pct bound_p95_px true_p95_px violations bytes_per_frame hidden_bytes_pct
//   hidden_cells_pct hidden_cpu_pct cpu_ms resampling_ceiling_db turn_deg offset_cm
// Figures are medians over the poses whose residual turn lies inside the guard band, psnr_p10_db
// the 10th percentile; psnr and flip count every pixel, black ones too. resampling_ceiling_db is
// what the filter does at its worst: a frame of the very pose, its cells half a pixel off. error_*
// are shares of the squared error: of filled pixels, of others within two pixels of another
// surface; turn_deg and offset_cm are what is left between the rendered and the shown pose.
// Methods, each more than the one before: stale, rotation (without a guard band), rotation_guard,
// mesh (stretched over silhouettes), mesh_cut, mesh_cut_splat, predicted (mesh_cut_splat of a frame
// rendered at the pose that pose::Predictor foretold at 72 samples a second), layered
// (mesh_cut_splat with the second layer of a view cell of 5 cm) and layered_predicted; and grid,
// the cheaper mesh_cut_splat of slow machines. Columns of the second layer, of bytes and of the
// bound are there for the layered ones: hidden_* are the layer's shares of the frame's bytes, cells
// and rendering time; bound_p95_px is reprojection::ErrorBound over the cells in sight, true_p95_px
// how far nine points of each cell, hit by rays of their own, lie from where the warp shows them,
// and violations the most of them in one pose that lie beyond their bound.
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.h"

namespace macula::bench {

struct ReprojectionOptions {
  std::vector<std::string> scenes{"posts", "atrium", "city"};
  std::vector<std::string> traces;  ///< CSV files; none: the client's made-up viewer
  std::vector<double> latencies_ms{0.0, 20.0, 50.0, 100.0, 150.0, 200.0};
  std::vector<std::string> methods;  ///< empty: all
  std::vector<double> source_scales{1.0, 1.5};
  std::string material = "lambert";
  std::string codec = "none";  ///< "default": frames are coded and decoded as the server does
  bool foveated = false;       ///< frames lie on a foveal grid, gaze straight ahead
  std::string rate_model = "cortical";  ///< of that grid; the server's default
  int side_px = 600;                    ///< of the square display
  int poses = 10;                       ///< of a row
  int threads = 0;                      ///< of the renderer
  std::string pictures;                 ///< folder: pictures of the last pose, and of their errors
  std::string json;                     ///< rows it holds already are kept
};
/// Two scenes, latencies 0, 50 and 100 ms, source scale 1, three poses.
void make_quick(ReprojectionOptions& options);

/// Prints the table. Errors name the option, scene or trace at fault.
Result<void> run_reprojection(const ReprojectionOptions& options);

}  // namespace macula::bench
