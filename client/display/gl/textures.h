// Fills textures that somebody else made, such as a headset's. Every call needs a context of that
// texture to be current. Rows are turned over: OpenGL's first row is a picture's last.
#pragma once

#include <vector>

#include "shared/image/color.h"
#include "shared/image/plane.h"

namespace macula::display {

/// Keeps its memory from picture to picture. One thread.
class TextureFiller {
 public:
  /// Display-encoded colour into a texture of the picture's size, one with sRGB colours included:
  /// values are stored as they are.
  void fill(unsigned texture, const image::Plane<Rgb8>& picture);
  /// Depth as the depth buffer has it, 0 to 1; values beyond are clamped.
  void fill_depth(unsigned texture, const image::Plane<float>& depth);

 private:
  std::vector<Rgb8> colors_;
  std::vector<float> depths_;
};

}  // namespace macula::display
