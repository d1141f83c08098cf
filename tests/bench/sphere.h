// `macula-bench sphere`: what kernel `sphere` gains over plain sphere tracing and what it costs in
// quality, over moving frames of distance fields (Figures 4, 11, 12 and Table 1 of the 2023 paper).
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.h"

namespace macula::bench {

struct SphereOptions {
  std::vector<std::string> scenes{"temple", "columns", "primitives"};
  int width_px = 2468, height_px = 2740;  ///< an eye, as the paper's headset asks for
  std::vector<double> fovea_deg{2.5, 5.0, 7.5, 10.0, 12.5, 15.0};
  std::vector<int> samples{1, 2, 4, 8, 16};
  std::vector<int> refresh{1, 2, 4};        ///< frames between refreshes of unimportant cells
  std::vector<std::string> edges{"depth"};  ///< depth, albedo, shaded
  std::vector<int> views{1};                ///< 1: one eye, 2: both
  std::vector<std::string> methods{"full", "full_best", "ipr_paper", "ipr", "fipr_paper", "fipr"};
  int frames = 16;
  /// Of them, the frames at which methods without memory are rendered and compared, spread to the
  /// end: their cost does not depend on what came before.
  int key_frames = 2;
  int threads = 0;
  std::string pictures;  ///< folder for pictures of the last key frame and its steps; empty: none
  std::string json;      ///< rows that it holds already are not measured again; empty: none
};

/// The same at half the resolution, three foveae, 1 and 16 samples, refresh 1 and 1/4, 8 frames.
void make_quick(SphereOptions& options);

Result<void> run_sphere(const SphereOptions& options);

}  // namespace macula::bench
