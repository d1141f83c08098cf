// Cache update and merging (section 3.4): new samples join what is remembered, cells that nobody
// knows are filled from the support image, and the frame's planes are written. Cells are
// independent of each other and of threads.
#pragma once

#include <algorithm>
#include <span>

#include "server/kernels/kernel.h"
#include "server/kernels/ray/blend.h"
#include "server/kernels/ray/cache.h"
#include "server/kernels/ray/foveated_config.h"
#include "server/kernels/ray/glossy_turn.h"
#include "server/kernels/ray/resampling.h"
#include "server/kernels/ray/sampling_mask.h"

namespace macula::kernels::ray {

/// Cells that are sent for before one of them is merged: about as long as memory takes.
inline constexpr std::size_t kAhead = 16;

/// What is remembered of a row of cells and of those above and below: 1/m, negative where nothing
/// is. At the picture's border the row itself stands for what is missing.
struct DepthRows {
  const float* above;
  const float* here;
  const float* below;
  int width;

  static DepthRows of(const Plane<float>& plane, int y) {
    const auto row = [&](int j) { return plane.row(std::clamp(j, 0, plane.height() - 1)).data(); };
    return {row(y - 1), row(y), row(y + 1), plane.width()};
  }
};

struct MergeJob {
  const View& view;
  const Support& support;
  const SamplingMask& mask;
  const FreshSamples& fresh;
  const FoveatedConfig& config;
  std::uint32_t clock = 0;
  Motion motion = Motion::Moving;
  GlossyPast glossy{};
  std::uint64_t frame = 0;  ///< for the post filter's probes
  LimitTable color_limits{config.color_age}, light_limits{config.light_age};
};

/// Blends the fresh samples of these columns of row y into `cache`, and shows them in `radiance`;
/// `remembered` are the depths around that row. Depths in the cache stay.
void update_row(const MergeJob& job, int y, std::span<const int> columns,
                const DepthRows& remembered, Cache& cache, Plane<Rgb>& radiance);
/// The same for `cells` anywhere. Depths in the cache stay the remembered ones until
/// finish_cells(), because neighbours are held against them.
void update_cells(const MergeJob& job, std::span<const image::Pixel> cells, Cache& cache,
                  Plane<Rgb>& radiance);
/// Gives the cache and the frame the new depth of a traced cell, or of `cells`.
void finish_cell(const MergeJob& job, int x, int y, Cache& cache, Plane<float>& depth_m);
void finish_cells(const MergeJob& job, std::span<const image::Pixel> cells, Cache& cache,
                  Plane<float>& depth_m);
/// Fills cells that are neither traced nor remembered.
void fill_cells(const MergeJob& job, std::span<const image::Pixel> cells, Cache& cache,
                ViewBuffers& out);
/// Shows resampled cells under their neighbours' light (section 3.5).
void post_filter_cells(const MergeJob& job, std::span<const image::Pixel> cells, const Cache& cache,
                       Plane<Rgb>& radiance);

/// What is remembered of row y, as radiance and depth.
void show_row(const Cache& cache, int y, ViewBuffers& out);
/// The other planes that `out` has: rows [first, last).
void copy_rows(const Cache& cache, int first, int last, ViewBuffers& out);

}  // namespace macula::kernels::ray
