// Metrics that know where the eye looks. Eccentricity is the angle between a pixel's view ray and
// the gaze ray. EW-PSNR weighs squared error by the density of resolvable samples (acuity line of
// Guenter, Finch, Drucker, Tan, Snyder 2012); GP-PSNR filters the error by Geisler and Perry's
// (1998) contrast sensitivity, so that error nobody can resolve at its eccentricity costs nothing.
// Pictures are sRGB-encoded [0, 1]. Pure functions.
#pragma once

#include "shared/image/color.h"
#include "shared/image/plane.h"
#include "shared/math/vec.h"
#include "shared/units/angle.h"

namespace macula::metrics {

using image::Plane;

/// A planar picture with square pixels and a gaze, all in pixels from the top-left corner (pixel
/// (i, j) has its centre at (i + .5, j + .5)).
struct GazedView {
  double focal_px = 0.0;  ///< distance of the eye from the picture, > 0
  DVec2 axis_px{0.0};     ///< where the view axis meets the picture, usually its middle
  DVec2 gaze_px{0.0};     ///< where the gaze meets it; may lie outside

  /// The view axis through the middle and this many pixels per degree there.
  static GazedView centred(int width_px, int height_px, double pixels_per_degree);

  /// Of the direction through a point of the picture.
  Radians eccentricity(const DVec2& position_px) const;
  /// Cosine of the angle between that direction and the view axis, in (0, 1].
  double axis_cosine(const DVec2& position_px) const;
  /// Pixels per degree on the axis.
  double pixels_per_degree() const;
};

/// Smallest resolvable detail in the fovea is 1/48 degree and grows by this per degree: the lower
/// end of the 1.32-1.65 arc minutes per degree that Guenter et al. report, strictest on the
/// periphery.
inline constexpr double kAcuitySlope = 0.022;

/// w(e) = 1 / (1 + 48 slope e)^2 with e in degrees: 1 in the fovea, falling outwards.
double acuity_weight(Radians eccentricity);
/// w at every pixel; where the picture spans more than 90 degrees also times the pixel's solid
/// angle, cos^3 of the angle to the axis.
Plane<float> acuity_weights(const GazedView& view, int width_px, int height_px);
/// sum w v / sum w; for a map cropped by a filter (SSIM) the border of the weights is left out
/// evenly.
double weighted_mean(const Plane<float>& values, const Plane<float>& weights);

/// PSNR of the weighted mean of squared differences over all channels, dB, at most 99.
double ew_psnr_db(const Plane<Rgb>& encoded_reference, const Plane<Rgb>& encoded_test,
                  const GazedView& view);

/// Highest frequency visible at an eccentricity, cycles per degree: 39.2 at 0, 7.3 at 10, 2.1
/// at 40.
double cutoff_cpd(Radians eccentricity);
/// Relative contrast sensitivity exp(-.106 f (e / 2.3)), e in degrees; 0 above the cutoff.
double contrast_sensitivity(double frequency_cpd, Radians eccentricity);

enum class Sensitivity { GeislerPerry, Flat };
/// PSNR of the luma difference after that filter, dB, at most 99. Flat leaves the filter out; the
/// band sum then agrees with PSNR within about 2 dB.
double gp_psnr_db(const Plane<Rgb>& encoded_reference, const Plane<Rgb>& encoded_test,
                  const GazedView& view, Sensitivity sensitivity = Sensitivity::GeislerPerry);

}  // namespace macula::metrics
