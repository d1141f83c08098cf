// Reprojector: the last frame's cache as this frame's view sees it (section 3.2). The default is a
// backward warp: every cell is placed by the depth between this frame's support samples, and what
// lay there is taken if its own depth agrees; where it does not, its depth is tried in turn, then
// the corners of the support quad, nearest first. Colours are filtered, cache info never.
#pragma once

#include <optional>

#include "server/kernels/kernel.h"
#include "server/kernels/ray/cache.h"
#include "server/kernels/ray/foveated_config.h"
#include "server/kernels/ray/history_filter.h"
#include "server/kernels/ray/support.h"
#include "server/reconstruction/row_warp.h"

namespace macula::kernels::ray {

struct ReprojectJob {
  const Cache& then;
  const Pose& world_from_then;
  const PixelGrid& grid_then;
  const View& view;
  const Support& support;
  const FoveatedConfig& config;
  std::uint64_t frame = 0;  ///< for HistoryFilter::NormalTaps
};

class Reprojector {
 public:
  /// Refers to both; they must outlive it. `now` has the view's size and the planes of `then`.
  Reprojector(const ReprojectJob& job, Cache& now);

  /// Fills rows [first, last) of the cache; inverse_depth is kNothing where nothing is remembered.
  /// Rows may be filled by several threads at once.
  void rows(int first, int last) const;

 private:
  using Place = reconstruction::RowWarp::Place;
  struct Found {
    Place place;
    float inverse_depth_now = 0.0F;
  };

  std::optional<Found> find(int x, int y, const Place& guess, float guessed_depth) const;
  std::optional<Found> follow(int x, int y, Place place) const;
  bool inside(const Place& place) const;
  float depth_at(const Place& place) const;
  bool agrees(const Place& place) const;
  void write(int x, int y, const std::optional<Found>& found) const;

  const ReprojectJob& job_;
  Cache& now_;
  reconstruction::RowWarp warp_;
  HistoryTaps taps_;
};

}  // namespace macula::kernels::ray
