// Errors counted pixel by pixel: MSE and relMSE in linear light (convergence and bias), PSNR on
// display-encoded values (what a screen shows). Both pictures have the same size; sums are in
// double. A NaN in a picture makes the result NaN. Pure functions.
#pragma once

#include "shared/image/color.h"
#include "shared/image/plane.h"

namespace macula::metrics {

using image::Plane;

/// What PSNR-like figures report for no error at all, and their upper bound.
inline constexpr double kBestDb = 99.0;
/// Keeps relMSE finite in the dark, in squared radiance; the usual choice of Monte Carlo papers.
inline constexpr double kRelativeMseEpsilon = 1e-2;

/// Mean of (test - reference)^2 over pixels and channels; 0 for empty pictures.
double mse(const Plane<Rgb>& reference, const Plane<Rgb>& test);
double rmse(const Plane<Rgb>& reference, const Plane<Rgb>& test);
/// Mean of (test - reference)^2 / (reference^2 + epsilon) over pixels and channels, linear light.
double relative_mse(const Plane<Rgb>& reference, const Plane<Rgb>& test,
                    double epsilon = kRelativeMseEpsilon);

/// -10 log10(mse / peak^2), at most kBestDb.
double db_from_mse(double mean_squared_error, double peak = 1.0);
/// Of sRGB-encoded pictures in [0, 1], over all channels.
double psnr_db(const Plane<Rgb>& encoded_reference, const Plane<Rgb>& encoded_test);

/// 8-bit display values as [0, 1] floats, no change of transfer function.
Plane<Rgb> unit_from_8bit(const Plane<Rgb8>& encoded);
/// Luma of encoded values, ITU-R BT.601 weights (.299 .587 .114).
Plane<float> luma(const Plane<Rgb>& encoded);

}  // namespace macula::metrics
