// `macula-bench codecs`: colour codecs on frames of a kernel while the head pans at 60 degrees a
// second and the frame rate is 72 Hz. One eye, 3x3 fixed samples a cell (noise-free), on the
// display's raster or on a foveal grid. Rows
//   scene grid codec quality bytes_per_frame psnr_f10_db psnr_out10_db encode_cpu_ms decode_cpu_ms
//   f10_gain_db out10_gain_db
// PSNR is of cells. Gains are of h264 with quantiser offsets over h264 without, read off the
// latter's curve at equal bytes. Times are CPU times of one eye, medians over the frames; a stereo
// pair takes twice as much.
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.h"

namespace macula::bench {

struct CodecsOptions {
  std::vector<std::string> scenes{"atrium"};
  std::vector<std::string> grids{"uniform", "foveal"};
  int width_px = 720, height_px = 800;  ///< of the coded picture where the grid is uniform
  double vertical_fov_deg = 90.0;
  int frames = 24;
  double coarsest = 5.0;  ///< of the offsets, and minus that the finest
  int threads = 0;
  std::string json;
};

Result<void> run_codecs(const CodecsOptions& options);

}  // namespace macula::bench
