#include "tests/bench/other_maps.h"

#include <algorithm>
#include <cmath>

namespace macula::bench {
namespace {

/// ALVR's constants of one axis, aligned to whole blocks of 2 e pixels.
struct AlvrConstants {
  AlvrConstants(int full_px, const AlvrAxis& axis) {
    const double full = full_px, e = axis.edge_ratio, block = 2.0 * e;
    const double center = 1.0 - std::ceil((full - axis.center_size * full) / block) * block / full;
    const double edge_px = full - center * full;
    const double shift = std::ceil(axis.center_shift * edge_px / block) * block / edge_px;
    const double c0 = (1.0 - center) / 2.0;
    c1 = (e - 1.0) * c0 * (shift + 1.0) / e;
    c2 = (e - 1.0) * center + 1.0;
    low = c0 * (shift + 1.0) / c2;
    high = c0 * (shift - 1.0) / c2 + 1.0;
    ratio = e;
    encoded_px = (center + (1.0 - center) / e) * full;
  }
  /// Full-picture coordinate of an encoded one.
  double at(double u) const {
    const double inside = u * c2 / ratio + c1;
    if (u < low) {
      const double g = u / low;
      return g * inside + (1.0 - g) * u * c2;
    }
    if (u > high) {
      const double g = (1.0 - u) / (1.0 - high);
      return g * inside + (1.0 - g) * ((u - 1.0) * c2 + 1.0);
    }
    return inside;
  }
  double c1 = 0.0, c2 = 0.0, low = 0.0, high = 0.0, ratio = 0.0, encoded_px = 0.0;
};

double curve_error(double a, const WivrnAxis& axis) {
  return std::atan(a * (1.0 - axis.gaze) / axis.pixel_share) +
         std::atan(a * (1.0 + axis.gaze) / axis.pixel_share) - 2.0 * a;
}

/// Whole pixels per cell on one side of the gaze, from it outwards, until `room` is used up.
std::vector<int> spans_outwards(const WivrnCurve& curve, double from, double sign, int room,
                                double cell) {
  std::vector<int> spans;
  int used = 0, last = 1;
  for (double x = from + 0.5 * sign * cell; used < room; x += sign * cell) {
    const double wanted = curve.pixel_ratio(std::clamp(x, -1.0, 1.0));
    last = std::max(last, static_cast<int>(std::lround(wanted)));
    spans.push_back(std::min(last, room - used));
    used += spans.back();
  }
  return spans;
}

}  // namespace

std::vector<double> alvr_edges(int full_px, const AlvrAxis& axis) {
  const AlvrConstants map(full_px, axis);
  const int cells = static_cast<int>(std::lround(map.encoded_px));
  std::vector<double> edges;
  for (int k = 0; k <= cells; ++k) edges.push_back(map.at(static_cast<double>(k) / cells));
  return edges;
}

double WivrnCurve::pixel_ratio(double x) const {
  const double t = std::tan(a * x + b);
  return 1.0 + t * t;
}

WivrnCurve wivrn_curve(const WivrnAxis& axis) {
  // The error falls from + to - between 0 (where it is 0 too) and pi / 2.
  double low = 1e-6, high = 1.5707963267948966;
  for (int step = 0; step < 100; ++step) {
    const double middle = 0.5 * (low + high);
    (curve_error(middle, axis) > 0.0 ? low : high) = middle;
  }
  WivrnCurve curve;
  curve.a = 0.5 * (low + high);
  curve.b = std::atan(curve.a * (1.0 - axis.gaze) / axis.pixel_share) - curve.a;
  return curve;
}

std::vector<double> wivrn_edges(int full_px, const WivrnAxis& axis) {
  const WivrnCurve curve = wivrn_curve(axis);
  const double cell = 2.0 / (axis.pixel_share * full_px);
  const int gaze_px =
      std::clamp(static_cast<int>(std::lround(0.5 * (axis.gaze + 1.0) * full_px)), 1, full_px - 1);
  const double at_gaze = -curve.b / curve.a;  // where f = c
  const auto left = spans_outwards(curve, at_gaze, -1.0, gaze_px, cell);
  const auto right = spans_outwards(curve, at_gaze, 1.0, full_px - gaze_px, cell);
  std::vector<double> edges{0.0};
  const auto add = [&](int span) {
    edges.push_back(edges.back() + static_cast<double>(span) / full_px);
  };
  std::for_each(left.rbegin(), left.rend(), add);
  std::for_each(right.begin(), right.end(), add);
  return edges;
}

PixelGrid grid_of_edges(const foveation::Display& display, const std::vector<double>& x,
                        const std::vector<double>& y) {
  const DVec2 low = display.fov.tangent_min(), size = display.fov.tangent_max() - low;
  PixelGrid grid;
  for (const double v : x) grid.x_edges.push_back(static_cast<float>(low.x + v * size.x));
  for (const double v : y) grid.y_edges.push_back(static_cast<float>(low.y + v * size.y));
  return grid;
}

}  // namespace macula::bench
