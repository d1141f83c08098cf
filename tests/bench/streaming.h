// `macula-bench streaming`: a real server and a real connection through links that misbehave, and a
// viewer that plays a recorded trace at 72 refreshes a second and notes what it would show. Rows
//   source link codec trace fps shown_pct transit_p50_ms transit_p99_ms age_p50_ms age_p95_ms
//   age_p99_ms gaze_age_p95_ms kbps bytes_per_frame encode_cpu_ms decode_cpu_ms psnr_f10_db
//   psnr_out10_db gp_psnr_db closure_error_max_ms clock_error_max_ms clock_bound_broken
//   recovery_ms slow_age_p95_ms stall_max_ms cells_pct fresh_age_p95_ms
//   render_p95_ms render_p50_ms credit_wait_p50_ms, and <stage>_p50_ms <stage>_p95_ms of each stage
// A frame is rendered, encoded, waits for its credit and crosses the link: transit is from its
// hand-over to the network to its last byte. Ages are from reading the pose (or gaze) behind a
// frame to the refresh that shows it, of every refresh; fresh_age_p95_ms of frames when first
// shown. The viewer fetches frames 5 ms before the light, as a warp would, and tells its head every
// 4 ms until then. Both ends read one clock here, so the true clock offset is 0. recovery_ms: from
// the end of the link's own outage to the first new frame shown. PSNR is of cells against the
// source, gp_psnr of the picture warped to the frame's own pose against the source on the display's
// raster; both of a few frames, of eye 0, where the source is `pattern`.
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.h"

namespace macula::bench {

struct StreamingOptions {
  std::string source = "pattern";  ///< or a scene, rendered by its kernel
  std::vector<std::string> links;  ///< empty: all that need no file
  std::string network_folder;      ///< recorded links (CSV); each becomes a row
  std::string trace;               ///< CSV; empty: the client's made-up viewer
  std::string codec = "auto";
  std::string effort = "ultrafast";
  double seconds = 60.0;                ///< a link
  int width_px = 720, height_px = 800;  ///< of an eye's display
  double vertical_fov_deg = 90.0;
  double age_ms = 100.0;  ///< the server's goal; 0: none
  int quality = 85;
  int frame_kb = 0;  ///< canned: JPEG of the quality that gives so many; 0: as set
  double noise_levels = 0.0;
  std::string grid = "foveal";  ///< or uniform
  std::string json;
};
/// 20 s a link.
void make_quick(StreamingOptions& options);
std::vector<std::string> link_names();

/// Prints the table. Errors name the option or file at fault.
Result<void> run_streaming(const StreamingOptions& options);

}  // namespace macula::bench
