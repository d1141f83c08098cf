// CanvasSize: how large a picture H.264 codes for frames whose size follows the gaze. Whole
// macroblocks; grows at once, shrinks by a quarter or more at most every two seconds. A value.
#pragma once

#include "shared/units/time.h"

namespace macula::codec {

class CanvasSize {
 public:
  /// Makes room for a frame; true when the size changed.
  bool fit(int width_px, int height_px, Nanoseconds now);
  int width_px() const { return across_.size; }
  int height_px() const { return down_.size; }

 private:
  struct Side {
    int size = 0;
    int most_lately = 0;  ///< needed since `since`
  };
  static bool grow(Side& side, int needed);
  static bool shrink(Side& side);

  Side across_, down_;
  Nanoseconds since_{0};
};

}  // namespace macula::codec
