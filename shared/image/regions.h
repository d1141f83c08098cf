// F5, F10, F25: the discs of 5, 10 and 25 degrees of eccentricity that every error is reported in,
// and their outsides. A mask is given per pixel as its eccentricity.
#pragma once

#include <vector>

#include "shared/image/plane.h"
#include "shared/units/angle.h"

namespace macula::image {

enum class Region { All, F5, F10, F25, Out10, Out25 };

/// "all", "f5", "f10", "f25", "out10", "out25".
const char* name(Region region);
/// Whether a pixel of this eccentricity belongs to the region; the disc is closed (e <= radius).
bool contains(Region region, Radians eccentricity);

}  // namespace macula::image
