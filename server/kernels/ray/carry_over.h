// CarryOver: the last frame's memory brought into this one, row by row while a row is at hand:
// found where this view sees it, shown, and joined by the samples of the cells that were chosen
// (sections 3.2 and 3.4). Cells that are resampled join later: what is learned here asks for them.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "server/kernels/ray/cache.h"
#include "server/kernels/ray/merge.h"
#include "server/kernels/ray/reproject.h"
#include "server/kernels/ray/resampling.h"

namespace macula::kernels::ray {

class CarryOver {
 public:
  /// Refers to all of them. `moved` brings the memory to a view that differs; null where `now`
  /// already is this view's, but for its depths, which are `depths_then`. The planes of
  /// `luminance` have the support's size.
  CarryOver(const MergeJob& merge, const Reprojector* moved, const Plane<float>& depths_then,
            Cache& now, ViewBuffers& out, SupportLuminance& luminance);

  /// What came of some rows.
  struct Brought {
    /// Cells that are neither chosen nor remembered, row by row.
    std::vector<image::Pixel> forgotten;
    double joining_ms = 0.0;  ///< how long samples took to join
  };
  /// Rows [first, last) of the cache and the frame. Any rows may be brought by several threads at
  /// once.
  Brought rows(int first, int last) const;

 private:
  /// Depths of three rows, each at its number modulo 3.
  struct Window {
    Reprojector::Row row;
    std::array<std::vector<float>, 3> depths;
    std::vector<int> chosen;
  };

  void find(int y, Window& window) const;
  void show(int y, const Reprojector::Row& row) const;
  void note_luminance(int y, std::span<const float> depths) const;
  void join(int y, Window& window, Brought& brought) const;
  void list_cells(int y, std::span<const float> depths, Window& window, Brought& brought) const;

  const MergeJob& merge_;
  const Reprojector* moved_;
  const Plane<float>& depths_then_;
  Cache& now_;
  ViewBuffers& out_;
  SupportLuminance& luminance_;
};

}  // namespace macula::kernels::ray
