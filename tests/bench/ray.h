// `macula-bench ray`: Table 1 and Figure 5 of the foveated ray tracing paper on our scenes. One eye
// of a DK2 on a moving path, the paper's three lightings, foveated against the full renderer in one
// run. A row is a scene, a lighting, a preset and a grid; its columns are
//   scene lighting preset grid width_px height_px rays_full rays_foveated mrays_s_full mrays_s_raw
//   cpu_full_ms cpu_foveated_ms wall_full_ms wall_foveated_ms reproject_ms trace_ms cache_ms
//   merge_ms post_ms speedup rmse_f10_full rmse_f10_foveated rmse_ring_full rmse_ring_foveated
//   rmse_ring_uniform rmse_out25_foveated gp_psnr_full_db gp_psnr_foveated_db psnr_support_db
//   psnr_foveated_db flicker_t1
// Rays and times are means over frames; times are CPU times but for wall_*; trace_ms holds rays and
// shading. Errors are of exposed linear radiance, 1 is display white, held below 4: cross-MSE
// against two independent half-references on key frames. The ring is 10 to 25 degrees of
// eccentricity, `uniform` a uniform grid at equal CPU time. Flicker is the temporal RMS of display
// luma while nothing moves.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/base/result.h"

namespace macula::bench {

struct RayOptions {
  std::string scene;
  std::vector<std::string> lightings{"point", "area8", "ao16"};
  std::vector<std::string> presets{"small", "medium", "large", "full"};
  std::vector<std::string> grids{"uniform", "foveal"};
  int width_px = 1182, height_px = 1464;
  int frames = 48;
  int key_frames = 4;
  int reference_samples = 64;  ///< primary samples a pixel of each half-reference
  bool quick = false;          ///< 591 x 732, 24 frames, medium, two key frames
  bool paper_literal = false;  ///< every form as printed, and its lighting
  bool phong = false;          ///< the paper's lobes alone
  bool post_filter = false;
  std::uint64_t seed = 1;
  int threads = 0;
  std::string references;  ///< folder of half-references; empty: the user's cache
  std::string pictures;    ///< folder for the last key frame's pictures; empty: none
  std::string json;
};

/// Prints the table. Errors name the option or file at fault and what is allowed.
Result<void> run_ray(const RayOptions& options);

}  // namespace macula::bench
