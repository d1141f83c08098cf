// `macula-bench culling`: kernel culling against its baselines on scenes under one lamp, at equal
// numbers of lights and at equal time (Table 2, figures 6, 8 and 9 of the 2021 paper).
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.h"

namespace macula::bench {

struct CullingOptions {
  std::vector<std::string> scenes{"nave", "atrium", "city"};
  std::vector<std::string> motions{"static", "light", "object", "both"};
  std::vector<std::string> methods;  ///< empty: all of culling_methods()
  std::vector<int> kept{256, 512, 1024, 2048, 4096};
  /// Of the rivals, whose errors are read off at other methods' times, by one that takes flc's time
  /// for each (the others: so many times lights_at_equal_time); empty: kept.
  std::vector<int> rivals_kept;
  int side_px = 1024;
  int judged = 1024;             ///< pixels inside the fovea, and as many outside
  int reference_samples = 4096;  ///< paths for each of them, of each half-reference
  int warm_up = 8;               ///< frames that are not measured
  int frames = 4;                ///< frames that are timed; the last is judged
  int seed = 1;                  ///< of every draw: another one tells what is chance
  int threads = 0;               ///< 0: all the machine has
  std::string knobs;             ///< of the kernel, turned for every method; "name=value ..."
  std::string references;        ///< folder; empty: ~/.cache/macula-bench
  std::string pictures;          ///< folder for the judged pictures; empty: none
  std::string json;              ///< rows that it holds already are not measured again; empty: none
};

/// 512 x 512, everything moves, the methods that answer who is nearest at equal time, one number of
/// lights (two of rivals), fewer frames, pixels and paths.
void make_quick(CullingOptions& options);

Result<void> run_culling(const CullingOptions& options);

}  // namespace macula::bench
