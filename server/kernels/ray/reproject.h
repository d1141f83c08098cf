// Reprojector: the last frame's cache as this frame's view sees it (section 3.2). The default is a
// backward warp: every cell is placed by the depth between this frame's support samples, and what
// lay there is taken if its own depth agrees; where it does not, its depth is tried in turn, then
// the corners of the support quad, nearest first. Colours are filtered, cache info never.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "server/kernels/kernel.h"
#include "server/kernels/ray/cache.h"
#include "server/kernels/ray/foveated_config.h"
#include "server/kernels/ray/history_filter.h"
#include "server/kernels/ray/support.h"
#include "server/reconstruction/history_rows.h"

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

  /// A row on its way, and room for the cells of it that are looked for again.
  struct Row {
    int y = 0;
    /// Where every cell lies now: 1/m, kNothing where nothing is remembered.
    std::vector<float> inverse_depth;
    reconstruction::RowPlaces places;
    reconstruction::RowReads reads;

    std::vector<int> open;     ///< columns of the cells that the first look did not find
    std::vector<int> columns;  ///< of those that are looked for again
    std::vector<float> tangent_x, tried_depth;
    reconstruction::RowPlaces tried_places;
    reconstruction::RowReads tried_reads;
  };

  /// Finds what is remembered of the cells of row y. Rows may be found and written by several
  /// threads at once.
  void find(int y, Row& row) const;
  /// Fills that row of the cache.
  void write(const Row& row) const;

 private:
  bool in_vectors() const;
  void judge(const reconstruction::RowPlaces& places, reconstruction::RowReads& reads) const;
  void list_open(Row& row) const;
  void follow(Row& row) const;
  float followed_depth(const Row& row, int x) const;
  void try_corners(Row& row) const;
  void try_again(Row& row) const;
  void forget_unknown(Row& row) const;
  void find_one_by_one(Row& row) const;
  void read_one_by_one(const Row& row) const;
  std::size_t place_then(const Row& row, int x) const;
  void copy_info(int x, int y, std::size_t within) const;
  template <class Apply>
  void for_each_unfiltered(const Apply& apply) const;

  const ReprojectJob& job_;
  Cache& now_;
  reconstruction::RowWarp warp_;
  HistoryTaps taps_;
};

}  // namespace macula::kernels::ray
