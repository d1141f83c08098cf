// FLIP: the difference a person sees when flipping between two pictures. LDR-FLIP: Andersson,
// Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild, "FLIP: A Difference Evaluator for
// Alternating Images" (2020), with the separable filters of their later releases; HDR-FLIP:
// Andersson, Nilsson, Shirley, Akenine-Moller, "Visualizing Errors in Rendered High Dynamic Range
// Images" (2021), ACES tone curve. Inputs are linear Rec.709; the viewing distance enters as pixels
// per degree. Values are in [0, 1], 0 = no visible difference. Pure functions; HDR-FLIP uses a few
// threads, its result does not depend on how many.
#pragma once

#include "shared/image/color.h"
#include "shared/image/plane.h"

namespace macula::metrics {

using image::Plane;

/// 0.7 m from a 0.7 m wide display of 3840 px: the authors' default.
inline constexpr double kDefaultPixelsPerDegree = 67.0206;

/// LDR-FLIP of every pixel; display-linear [0, 1], clamped. Same sizes; pixels_per_degree in
/// (0, 1000], an HMD has about 15-25 at the gaze.
Plane<float> flip_map(const Plane<Rgb>& reference, const Plane<Rgb>& test,
                      double pixels_per_degree = kDefaultPixelsPerDegree);

/// The exposures HDR-FLIP looks at: equal steps in EV (the radiance is multiplied by 2^ev).
struct ExposureRange {
  double start_ev = 0.0;
  double stop_ev = 0.0;
  int count = 2;

  double ev(int index) const { return start_ev + index * (stop_ev - start_ev) / (count - 1); }
};

/// From the exposure that brings the reference's brightest pixel to 85 % of the tone curve to the
/// one that brings its median there; at least 2. Pictures that are mostly black have a median of 0,
/// which no exposure lifts: the median of the pixels that are lit stands in. All black: 0 EV twice.
ExposureRange automatic_exposures(const Plane<Rgb>& reference);

struct HdrFlip {
  Plane<float> map;  ///< per pixel the worst LDR-FLIP over all exposures
  ExposureRange exposures;
};
/// Any finite radiance; negative values count as 0.
HdrFlip hdr_flip(const Plane<Rgb>& reference, const Plane<Rgb>& test,
                 double pixels_per_degree = kDefaultPixelsPerDegree);

/// A FLIP map in numbers. The weighted quantiles are those of the error itself: half of all error
/// stands in pixels above `weighted_median`.
struct ErrorSummary {
  double mean = 0.0;
  double weighted_median = 0.0;
  double weighted_q1 = 0.0;
  double weighted_q3 = 0.0;
  double min = 0.0;
  double max = 0.0;
};
/// A NaN anywhere makes every field NaN.
ErrorSummary summarise(const Plane<float>& error_map);
/// Share of pixels whose error exceeds `threshold`, in [0, 1].
double fraction_above(const Plane<float>& error_map, float threshold);

}  // namespace macula::metrics
