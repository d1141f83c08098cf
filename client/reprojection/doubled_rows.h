// DoubledRows: fragments of every second pixel of every second row, brought to all pixels: places
// in the source between fragments that hang together are affine to a good deal less than a cell, so
// they are interpolated; at silhouettes each pixel takes its nearest fragment's. Internal to this
// room; one thread.
#pragma once

#include <vector>

#include "client/reprojection/fragments.h"

namespace macula::reprojection {

/// Neighbouring fragments farther apart in the source belong to different surfaces: twice what
/// frames of 1.5 cells a pixel have between every second pixel.
inline constexpr float kMostApart_cells = 6.0F;

class DoubledRows {
 public:
  /// Row `y` of the picture twice as wide and high, for pixels made of fragments [first, end); the
  /// fragments' band holds the rows above and below its half, as far as there are any. Valid until
  /// the next call.
  FragmentRow row(const Fragments& fragments, int y, int first, int end);

 private:
  /// Between two rows first, with an undrawn fragment before the first and after the last.
  struct Upright {
    std::vector<float> inverse_depth, u, v;
  };
  Upright upright_;
  std::vector<float> inverse_depth_, u_, v_;
};

}  // namespace macula::reprojection
