// `macula-bench lightcuts`: kernel lightcuts' methods against stochastic lightcuts with as many
// samples everywhere (sl), at equal time and at equal error. Radiance is compared on display-linear
// values at the row's exposure, by cross-MSE against two independent half-references.
#pragma once

#include <string>
#include <vector>

#include "server/kernels/lightcuts/config.h"
#include "shared/base/result.h"
#include "tests/bench/report.h"

namespace macula::bench {

struct LightcutsOptions {
  std::vector<std::string> scenes{"cornell-lights@stage", "study", "room", "yard"};
  bool quick = false;  ///< 360 x 425, one gaze unless told, one frame, fewer references
  std::vector<double> gazes_deg{0, 20};  ///< to the right of the view axis
  std::vector<std::string> methods;      ///< empty: all
  bool alphas = false;                   ///< Table 4: the paper's method at five thresholds too
  int reference_nodes = 256;  ///< of the cuts of each half-reference, every pixel of every pass
  int reference_passes = 4;   ///< of each half
  std::string references;     ///< folder that half-references are kept in; empty: PictureCache's
  int frames = 4;             ///< judged and timed, a seed each
  int warm_up = 16;           ///< frames of a moving head before those, for methods that remember
  int threads = 0;            ///< 0: all the machine has
  std::string pictures;       ///< folder for maps and pictures of every method; empty: none
  std::string json;           ///< report; empty: none
  /// What glossy surfaces reflect, of every method and in the references.
  kernels::lightcuts::Gloss gloss = kernels::lightcuts::Gloss::Yes;
  bool stereo = false;  ///< pairs of eyes instead, the gaze in the middle
};

/// For a report.
Fields effective(const LightcutsOptions& options);

Result<void> run_lightcuts(const LightcutsOptions& options);

}  // namespace macula::bench
