#include "tests/bench/reprojection_measures.h"

#include <algorithm>
#include <cmath>

#include "client/reprojection/error_bound.h"
#include "shared/metrics/error.h"
#include "shared/metrics/flip.h"
#include "shared/metrics/foveated.h"
#include "tests/bench/stopwatch.h"

namespace macula::bench {
namespace {

using reprojection::WarpOptions;

int squared_error(const Rgb8& a, const Rgb8& b) {
  const int r = a.r - b.r, g = a.g - b.g, bl = a.b - b.b;
  return r * r + g * g + bl * bl;
}

/// The disc of 10 degrees around the axis.
double f10_psnr_db(const image::Plane<Rgb8>& shown, const image::Plane<Rgb8>& expected,
                   const PixelGrid& raster) {
  const double least = std::cos(Radians{Degrees{10.0}}.value());
  double squares = 0.0, values = 0.0;
  for (int y = 0; y < shown.height(); ++y) {
    for (int x = 0; x < shown.width(); ++x) {
      if (1.0 / static_cast<double>(glm::length(raster.ray(x, y))) < least) continue;
      squares += squared_error(shown(x, y), expected(x, y));
      values += 3.0;
    }
  }
  return metrics::db_from_mse(squares / values, 255.0);
}

/// Whether another surface begins within two pixels.
bool is_by_silhouette(const image::Plane<float>& inverse_depth, int x, int y) {
  constexpr int kReach = 2;
  constexpr float kOtherSurface = 0.05F;  // relative step of inverse depth
  const float here = inverse_depth(x, y);
  for (int j = -kReach; j <= kReach; ++j) {
    for (int i = -kReach; i <= kReach; ++i) {
      if (!inverse_depth.contains(x + i, y + j)) continue;
      const float there = inverse_depth(x + i, y + j);
      if (std::abs(there - here) > kOtherSurface * std::max(here, there)) return true;
    }
  }
  return false;
}

/// Shares of a picture's squared error: of filled pixels, and of others by silhouettes.
struct ErrorShares {
  double filled_pct = 0.0, silhouette_pct = 0.0;
};
ErrorShares error_shares(const image::Plane<Rgb8>& shown,
                         const image::Plane<reprojection::Coverage>& coverage,
                         const SourcePicture& expected) {
  double all = 0.0, filled = 0.0, silhouette = 0.0;
  for (int y = 0; y < shown.height(); ++y) {
    for (int x = 0; x < shown.width(); ++x) {
      const int error = squared_error(shown(x, y), expected.color(x, y));
      if (error == 0) continue;
      all += error;
      if (coverage(x, y) == reprojection::Coverage::Filled) {
        filled += error;
      } else if (is_by_silhouette(expected.inverse_depth_per_m, x, y)) {
        silhouette += error;
      }
    }
  }
  return all > 0.0 ? ErrorShares{100.0 * filled / all, 100.0 * silhouette / all} : ErrorShares{};
}

}  // namespace

double percentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  const double place = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const double beyond = place - static_cast<double>(below);
  const double next = values[std::min(below + 1, values.size() - 1)];
  return (1.0 - beyond) * values[below] + beyond * next;
}

void add_sample(const SourcePicture& source, const SourcePicture& expected,
                const foveation::Display& display, const Method& method,
                reprojection::Warper& warper, image::Plane<Rgb8>& shown, Samples& samples) {
  image::Plane<reprojection::Coverage> coverage;
  Stopwatch watch;
  WarpOptions options = method.options;
  options.layers = method.layered ? WarpOptions::Layers::Both : WarpOptions::Layers::First;
  const auto report =
      warper.warp(source.view(), expected.stage_from_view, display, options, shown, &coverage);
  samples.cpu_ms.push_back(watch.lap().cpu_ms);
  const auto reference = metrics::unit_from_8bit(expected.color);
  const auto test = metrics::unit_from_8bit(shown);
  samples.f10_psnr_db.push_back(f10_psnr_db(shown, expected.color, expected.grid));
  const double ppd = display.pixels_per_degree();
  samples.psnr_db.push_back(metrics::psnr_db(reference, test));
  samples.gp_psnr_db.push_back(metrics::gp_psnr_db(
      reference, test, metrics::GazedView::centred(display.width_px, display.height_px, ppd)));
  samples.flip.push_back(metrics::summarise(metrics::flip_map(reference, test, ppd)).mean);
  const auto pixels = static_cast<double>(shown.size());
  samples.holes_pct.push_back(100.0 * report.filled_share());
  samples.outside_pct.push_back(100.0 * static_cast<double>(report.outside_px) / pixels);
  const ErrorShares shares = error_shares(shown, coverage, expected);
  samples.error_filled_pct.push_back(shares.filled_pct);
  samples.error_silhouette_pct.push_back(shares.silhouette_pct);
  if (method.layered) {
    samples.hidden_cells_pct.push_back(source.hidden_cells_pct);
    samples.hidden_cpu_pct.push_back(100.0 * source.hidden_cpu_ms /
                                     (source.cpu_ms + source.hidden_cpu_ms));
  }
  const Pose &from = source.stage_from_view, &to = expected.stage_from_view;
  samples.turn_deg.push_back(Degrees(math::angle_between(from, to)).value());
  samples.offset_cm.push_back(100.0 * glm::distance(from.position, to.position));
}

BoundCheck check_bound(const SourcePicture& source, const image::Plane<float>& fine_inverse_depth,
                       const Pose& to, const foveation::Display& display,
                       const WarpOptions& options) {
  const reprojection::SourceView view = source.view();
  const reprojection::ErrorBound bound(view, {source.depth_residual, source.residual_step_per_m},
                                       to, display, options);
  BoundCheck check;
  std::vector<double> bounds, errors;
  constexpr int kPoints = 3;
  for (int y = 0; y < source.color.height(); ++y) {
    for (int x = 0; x < source.color.width(); ++x) {
      const DVec2 shown = bound.place(x, y, 0.5, 0.5, source.inverse_depth_per_m(x, y));
      if (!(shown.x >= 0 && shown.x <= display.width_px && shown.y >= 0 &&
            shown.y <= display.height_px)) {
        continue;
      }
      const double most = bound.at(x, y);
      bounds.push_back(most);
      for (int i = 0; i < kPoints * kPoints; ++i) {
        const int column = i % kPoints, row = i / kPoints;
        const DVec2 place =
            bound.place(x, y, (column + 0.5) / kPoints, (row + 0.5) / kPoints,
                        fine_inverse_depth(kPoints * x + column, kPoints * y + row));
        const double error = glm::distance(place, shown);
        if (std::isnan(error)) continue;
        errors.push_back(error);
        if (error > most) ++check.violations;
      }
    }
  }
  check.bound_p95_px = percentile(std::move(bounds), 0.95);
  check.true_p95_px = percentile(std::move(errors), 0.95);
  return check;
}

image::Plane<Rgb8> error_picture(const image::Plane<Rgb8>& shown,
                                 const image::Plane<Rgb8>& expected) {
  image::Plane<Rgb8> picture(shown.width(), shown.height());
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const double rms = std::sqrt(squared_error(shown.data()[i], expected.data()[i]) / 3.0);
    const auto grey = static_cast<std::uint8_t>(std::min(4.0 * rms, 255.0));
    picture.data()[i] = {grey, grey, grey};
  }
  return picture;
}

}  // namespace macula::bench
