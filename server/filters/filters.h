// Filters on planes, each by OpenCV; the only room that knows it. Values are finite; pixels beyond
// the border repeat (Sobel, median) or mirror (all others) those within. Pure; safe from any
// thread; runs on the calling thread alone.
#pragma once

#include "shared/image/color.h"
#include "shared/image/plane.h"

namespace macula::filters {

using image::Plane;

/// Length of the 3 x 3 Sobel gradient, sqrt(sum over channels of Gx^2 + Gy^2): 8 on a ramp that
/// rises by 1 a pixel, 4 beside a step of 1.
Plane<float> sobel_length(const Plane<float>& plane);
Plane<float> sobel_length(const Plane<Vec3>& plane);

/// Mean over 5 x 5 pixels with Gaussian weights of standard deviation `sigma_px` > 0.
Plane<float> gaussian_mean(const Plane<float>& plane, float sigma_px);

/// Median over 5 x 5 pixels: lone outliers vanish, straight edges stay. Borders repeat.
Plane<float> median_of_25(const Plane<float>& plane);
/// Mean over 9 x 9 pixels with weights that fall as a Gaussian with distance and with difference in
/// value (Tomasi and Manduchi, 1998); standard deviations > 0, pixels and units of the plane. A
/// plane without any difference stays as it is.
Plane<float> bilateral_mean(const Plane<float>& plane, float sigma_px, float sigma_value);

/// Burt and Adelson, 1983, three levels: the finest band, plane - expand(reduce(plane)), signed;
/// and what two reductions leave, brought back to the plane's size. Reducing is 5 x 5 binomial.
struct LaplacianLevels {
  Plane<float> finest, residual;
};
LaplacianLevels laplacian_levels(const Plane<float>& plane);

/// To another size by bicubic interpolation (a = -0.75), which may overshoot; pixel centres at +
/// 0.5.
Plane<float> resize_bicubic(const Plane<float>& plane, int width, int height);

}  // namespace macula::filters
