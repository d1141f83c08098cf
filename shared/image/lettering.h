// Words on pictures for reports: one small typeface of 5 x 7 dots, letters without case, digits and
// the signs of numbers. What has no glyph becomes an empty box. Drawing is clipped to the picture.
#pragma once

#include <string_view>

#include "shared/image/color.h"
#include "shared/image/plane.h"

namespace macula::image {

/// Every dot of a letter is a square of `dot_px`.
int text_width_px(std::string_view text, int dot_px);
int text_height_px(int dot_px);
void draw_text(Plane<Rgb8>& picture, Pixel top_left, std::string_view text, int dot_px, Rgb8 color);

}  // namespace macula::image
