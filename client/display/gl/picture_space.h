// Sizes of pictures and places in them, as every display counts them.
#pragma once

namespace macula::display {

struct PictureSize {
  int width_px = 0, height_px = 0;
  friend bool operator==(const PictureSize&, const PictureSize&) = default;
};

/// Normalised to a picture: (0, 0) is its top left corner, (1, 1) its bottom right one.
struct PicturePoint {
  float u = 0.0F, v = 0.0F;
};

}  // namespace macula::display
