// What no triangle reached. A display pixel between drawn ones, sideways or upright, was uncovered
// by the camera's offset: it is filled from the farther end of the shorter way across, because what
// comes into sight is behind what moved away. Everything else lies beyond the frame. Internal to
// this room; one thread.
#pragma once

#include <cstdint>
#include <vector>

#include "client/reprojection/fragments.h"
#include "client/reprojection/warp.h"

namespace macula::reprojection {

class Holes {
 public:
  void clear() { gaps_.clear(); }
  /// Notes the undrawn pixels of a row; rows come top-down, each once.
  void note_row(const Fragments& fragments, int y);

  struct Counts {
    std::uint64_t filled_px = 0, outside_px = 0;
  };
  /// After the last row: marks every pixel unless `coverage` is null; under FillFartherSide holes
  /// in `colors` receive a drawn pixel's colour. Uses inverse depths alone. Each fragment stands
  /// for `side_px` x `side_px` pixels of both planes.
  Counts classify_and_fill(const Fragments& fragments, WarpOptions::Holes holes, int side_px,
                           image::Plane<Rgb8>& colors, image::Plane<Coverage>* coverage);

  /// An undrawn pixel and the nearest drawn ones in its row and column: their column or row.
  struct Gap {
    static constexpr int kNone = -1;
    int x, y;
    int left = kNone, right = kNone, upper = kNone, lower = kNone;

    bool enclosed() const {
      return (left != kNone && right != kNone) || (upper != kNone && lower != kNone);
    }
  };

 private:
  std::vector<Gap> gaps_;
};

}  // namespace macula::reprojection
