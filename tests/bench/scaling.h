// `macula-bench scaling`: one frame by several ranks. Measured for as many ranks as mpirun started,
// one after the other; beyond them the frames measured on one rank are replayed through a model of
// a cluster (cluster_model.h), which is held against the measured points first.
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.h"

namespace macula::bench {

struct ScalingOptions {
  std::vector<std::string> kernels;  ///< workloads; empty: all
  std::string scene;                 ///< empty: each workload's own
  int width_px = 1440, height_px = 1600;
  std::vector<std::string> gazes = {"0,0", "18,-12"};  ///< yaw, pitch in degrees
  int threads = 1;                                     ///< of each measured rank
  int warm_up = 2, frames = 3;                         ///< of a moving head; medians of the latter
  int rounds = 3;                                      ///< ranks take turns so often
  std::vector<int> ranks = {1, 2, 4, 8, 16, 32, 64, 128, 256};  ///< modelled
  std::vector<int> model_threads = {1, 16};                     ///< of each modelled rank
  double latency_us = 5.0, gbit_s = 25.0, copy_gb_s = 2.0;      ///< of the modelled cluster
  bool launched_by_mpi = false;
  std::string json;
};

void make_quick(ScalingOptions& options);
Result<void> run_scaling(const ScalingOptions& options);

}  // namespace macula::bench
