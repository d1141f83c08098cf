// Separable filters with odd support, row by row: the inner loop runs along the row, so the
// compiler vectorises it. Borders repeat the edge pixel. T is float or double. Pure functions.
#pragma once

#include <span>
#include <vector>

#include "shared/image/plane.h"

namespace macula::metrics {

using image::Plane;

/// 2 * radius + 1 weights; weight i belongs to the offset i - radius.
template <class T>
using Taps = std::vector<T>;

/// exp(-x^2 / (2 sigma^2)) at integers in [-radius, radius], sum 1.
template <class T>
Taps<T> gaussian_taps(double sigma_px, int radius_px);

/// Rows by `horizontal`, then columns by `vertical`:
/// out(x, y) = sum_jk vertical[j] horizontal[k] in(x + k - radius_h, y + j - radius_v).
template <class T>
Plane<T> filter_separable(const Plane<T>& in, const Taps<T>& horizontal, const Taps<T>& vertical);

}  // namespace macula::metrics
