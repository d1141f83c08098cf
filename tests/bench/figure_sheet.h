// Labelled sheets of pictures for reports: words under pictures, bars that tell what colours mean,
// outlines of regions, a title over rows of panels. Letters grow with the pictures: about forty of
// them are as wide as one. Pure.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "shared/image/color.h"
#include "shared/image/plane.h"

namespace macula::bench {

using image::Plane;

/// A square dot of the letters under a picture of this width.
int dot_px(int picture_width_px);

/// `below` is as wide as `above`.
Plane<Rgb8> stacked(const Plane<Rgb8>& above, const Plane<Rgb8>& below);
/// The picture over its lines; what is too long for one is cut off.
Plane<Rgb8> captioned(const Plane<Rgb8>& picture, std::span<const std::string> lines);

/// What false colour stands for, low < high. Decades: values are decimal logarithms.
enum class Ticks { Linear, Decades };
struct ColorScale {
  std::string what;
  float low = 0.0F, high = 1.0F;
  Ticks ticks = Ticks::Linear;
};
/// All colours from low to high, five values under them, and what they are.
Plane<Rgb8> scale_bar(const ColorScale& scale, int width_px);
Plane<Rgb8> false_color(const Plane<float>& values, const ColorScale& scale);

/// Draws the pixels of a region (not 0) that touch what lies outside, so many pixels thick.
/// `region` has the picture's size.
void outline(Plane<Rgb8>& picture, const Plane<std::uint8_t>& region, int thickness_px, Rgb8 color);
/// Every pixel as a square of so many; cut off at the size.
Plane<Rgb8> enlarged(const Plane<Rgb8>& picture, int factor, int width_px, int height_px);

struct Panel {
  Plane<Rgb8> picture;
  std::vector<std::string> lines;
};
struct FigureSheet {
  std::string title;
  int columns = 1;
  std::vector<Panel> panels;  ///< by rows, pictures of one width
  std::vector<ColorScale> scales;
};
/// The title, the panels, and the scales below one another as wide as all.
Plane<Rgb8> drawn(const FigureSheet& sheet);

}  // namespace macula::bench
