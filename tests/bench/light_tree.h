// `macula-bench light-tree`: what a light tree over moving lights costs to make, moment by moment,
// and how fast walks go down it, against one node at a time. CPU time, ratios within one run.
#pragma once

#include <string>

#include "shared/base/result.h"

namespace macula::bench {

struct LightTreeOptions {
  bool quick = false;  ///< a tenth of the repetitions
  std::string json;    ///< report; empty: none
};

Result<void> run_light_tree(const LightTreeOptions& options);

}  // namespace macula::bench
