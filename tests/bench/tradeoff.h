// `macula-bench tradeoff`: speed against accuracy. Every kernel's knobs, one at a time round its
// default and some together, on three scenes each: what a frame costs, what it weighs, and how far
// it is from the truth, beside whole pictures of equal time. Where asked it writes the quality
// ladders that macula-server goes up and down.
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.h"
#include "tests/bench/tradeoff_setting.h"

namespace macula::bench {

struct TradeoffOptions {
  std::vector<std::string> kernels{"ray", "lightcuts", "culling", "sphere"};
  std::vector<std::string> scenes;   ///< empty: each kernel's own three
  std::vector<std::string> configs;  ///< empty: all of the kernel's
  bool quick = false;                ///< small pictures, without the costliest configurations
  TradeoffScale scale;
  int threads = 0;         ///< 0: all the machine has
  std::string references;  ///< folder; empty: ~/.cache/macula-bench
  std::string pictures;    ///< folder for what each configuration shows; empty: none
  std::string ladders;     ///< folder for KERNEL.toml; empty: none
  std::string json;        ///< rows that it holds already are not measured again; empty: none
};

/// 160 x 160, 48 samples of each half-reference, 4 frames before 3.
void make_quick(TradeoffOptions& options);

Result<void> run_tradeoff(const TradeoffOptions& options);

}  // namespace macula::bench
