// Laplacian pyramid of a plane (Burt and Adelson 1983): octave-wide bands of spatial frequency.
// Kernel .05 .25 .4 .25 .05, coordinates clamped to the edge, even samples kept. Sample (i, j) of
// band b sits at the centre of pixel (i 2^b, j 2^b). Pure functions.
#pragma once

#include <vector>

#include "shared/image/plane.h"

namespace macula::metrics {

using image::Plane;

/// Low-pass and every second sample: ceil(width / 2) x ceil(height / 2).
Plane<float> reduce(const Plane<float>& in);
/// Back to width x height; constants stay constant, also at the border.
Plane<float> expand(const Plane<float>& in, int width, int height);
/// `bands` differences, finest first, then what is left. Expanding and adding gives `in` again.
std::vector<Plane<float>> laplacian_pyramid(const Plane<float>& in, int bands);

}  // namespace macula::metrics
