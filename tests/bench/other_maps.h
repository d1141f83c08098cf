// The foveation maps of two open streaming systems as grids, written from their published
// mathematics, to compare ours with: ALVR's axis-aligned distorted transfer (quadratic outside a
// one-to-one centre) and WiVRn's tangent map, rounded to whole source pixels. Both are one axis
// after the other; neither knows degrees.
#pragma once

#include <vector>

#include "shared/foveation/pixel_grid.h"

namespace macula::bench {

struct AlvrAxis {
  double center_size = 0.4;   ///< share of the full picture that is one to one
  double center_shift = 0.0;  ///< of it, in [-1, 1] of the room there is
  double edge_ratio = 4.0;    ///< full pixels per encoded one outside, on average
};
/// The encoded picture's cell edges in [0, 1] of a full picture of `full_px`.
std::vector<double> alvr_edges(int full_px, const AlvrAxis& axis);

struct WivrnAxis {
  double pixel_share = 0.5;  ///< lambda: encoded pixels per full one
  double gaze = 0.0;         ///< on the axis, in [-1, 1]
};
/// a and b of f(x) = (lambda / a) tan(a x + b) + c.
struct WivrnCurve {
  double a = 0.0, b = 0.0;
  /// Full pixels per encoded one at x in [-1, 1].
  double pixel_ratio(double x) const;
};
WivrnCurve wivrn_curve(const WivrnAxis& axis);
/// The same as edges in [0, 1], every cell a whole number of full pixels, growing outwards.
std::vector<double> wivrn_edges(int full_px, const WivrnAxis& axis);

/// Edges in [0, 1] of both axes over a display.
PixelGrid grid_of_edges(const foveation::Display& display, const std::vector<double>& x,
                        const std::vector<double>& y);

}  // namespace macula::bench
