// Comparison: two pictures of one view shown as one, so that an eye can tell them apart. Pure
// drawing; knows no window.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "shared/image/color.h"
#include "shared/image/plane.h"

namespace macula::display {

/// Wipe: the first left of the cursor, the second right of it. Flip: one of them, the other at a
/// key. Difference: what lies between them, four times as bright.
enum class ComparisonView { Off, Wipe, Flip, Difference };
/// Off, wipe, flip, difference, off.
ComparisonView next(ComparisonView view);

/// The second pictures of a comparison, by eye, of the first ones' sizes; they outlive the show.
struct Compared {
  std::array<const image::Plane<Rgb8>*, 2> second{};
  std::vector<std::string> lines;  ///< what the two are and how they differ; always on the screen
};

/// Columns from `share` of the width on are the second's, behind a white line of two columns.
/// `share` in [0, 1]; pictures of one size.
image::Plane<Rgb8> wiped(const image::Plane<Rgb8>& first, const image::Plane<Rgb8>& second,
                         float share);
/// Four times the absolute difference of each channel, at most 255.
image::Plane<Rgb8> difference_map(const image::Plane<Rgb8>& first,
                                  const image::Plane<Rgb8>& second);

}  // namespace macula::display
