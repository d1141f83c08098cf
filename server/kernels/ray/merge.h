// Cache update and merging (section 3.4): new samples join what is remembered, cells that nobody
// knows are filled from the support image, and the frame's planes are written. Cells are
// independent of each other and of threads.
#pragma once

#include <span>

#include "server/kernels/kernel.h"
#include "server/kernels/ray/cache.h"
#include "server/kernels/ray/foveated_config.h"
#include "server/kernels/ray/resampling.h"
#include "server/kernels/ray/sampling_mask.h"

namespace macula::kernels::ray {

struct MergeJob {
  const View& view;
  const Support& support;
  const SamplingMask& mask;
  const ViewBuffers& fresh;
  const FoveatedConfig& config;
  std::uint32_t clock = 0;
  Motion motion = Motion::Moving;
  std::uint64_t frame = 0;  ///< for the post filter's probes
};

/// Blends the fresh samples of `cells` into `cache`. Depths there stay the remembered ones until
/// write_frame(), because neighbours are held against them.
void update_cache(const MergeJob& job, std::span<const image::Pixel> cells, Cache& cache);

struct WriteCounts {
  std::size_t filled = 0;  ///< from the support image
  double post_ms = 0.0;    ///< CPU time of the post filter
};
/// Fills and writes rows [first, last) of the frame, and gives the cache its new depths.
WriteCounts write_frame(const MergeJob& job, int first, int last, Cache& cache, ViewBuffers& out);

}  // namespace macula::kernels::ray
