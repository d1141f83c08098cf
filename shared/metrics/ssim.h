// Structural similarity (Wang, Bovik, Sheikh, Simoncelli 2004): 11x11 Gaussian window of sigma 1.5,
// C1 = (0.01 L)^2, C2 = (0.03 L)^2, population variances and covariance (weights sum to 1), and the
// *valid* region only: the 5 border pixels, whose window would leave the picture, are not counted.
// That is scikit-image's structural_similarity(gaussian_weights=True, sigma=1.5,
// use_sample_covariance=False), which crops the same 5 px. Both pictures have the same size, at
// least 11x11. Pure functions.
#pragma once

#include "shared/image/color.h"
#include "shared/image/plane.h"

namespace macula::metrics {

using image::Plane;

/// Window side in px; a smaller picture has no valid region.
inline constexpr int kSsimWindow = 11;

/// SSIM of every window that fits, (width - 10) x (height - 10); `peak` is L.
Plane<float> ssim_map(const Plane<float>& reference, const Plane<float>& test, double peak = 1.0);
/// Mean of the map, in [-1, 1]; 1 = identical.
double ssim(const Plane<float>& reference, const Plane<float>& test, double peak = 1.0);
/// On the BT.601 luma of encoded [0, 1] pictures: Wang's definition for colour, and our headline.
double ssim_luma(const Plane<Rgb>& encoded_reference, const Plane<Rgb>& encoded_test);
/// Mean of the three channels' SSIM.
double ssim_rgb(const Plane<Rgb>& encoded_reference, const Plane<Rgb>& encoded_test);

}  // namespace macula::metrics
