// What the person at the desktop did since the last look: plain values, no window library.
#pragma once

#include <optional>

#include "client/display/gl/picture_space.h"

namespace macula::display {

/// A place in one of the pictures shown; 0 is the leftmost.
struct PictureTarget {
  int picture = 0;
  PicturePoint at;
};

struct Input {
  /// The gaze: the picture under the cursor and where. nullopt: over no picture. While frozen it
  /// stays where it was.
  std::optional<PictureTarget> gaze;
  bool gaze_frozen = false;
  /// Movement with the right button held since the last poll, in widths and heights of the picture;
  /// to the right and down.
  PicturePoint drag;
  /// Keys held now, each -1, 0 or 1: A D, Q E, S W.
  int right = 0, up = 0, forward = 0;
  bool reset = false;       ///< R was pressed since the last poll
  bool screenshot = false;  ///< P was
};

}  // namespace macula::display
