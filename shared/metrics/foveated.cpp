#include "shared/metrics/foveated.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shared/foveation/eccentricity.h"
#include "shared/metrics/error.h"
#include "shared/metrics/pyramid.h"

namespace macula::metrics {
namespace {

constexpr double kFoveaCyclesPerDegree = 48.0;
// Geisler and Perry: contrast threshold 1/64 at zero frequency, its growth per cycle per degree,
// and the eccentricity at which resolution has halved.
constexpr double kInverseThreshold = 64.0, kThresholdGrowth = 0.106, kHalfResolutionDegrees = 2.3;
constexpr int kBands = 5;
/// Measured centre of the first reduced band relative to the Nyquist frequency (Mantiuk et al.
/// 2021).
constexpr double kFirstReducedBand = 0.3228;
/// The picture is wide when its corner-free half axis exceeds 45 degrees.
constexpr double kWideHalfTangent = 1.0;

DVec3 direction(const GazedView& view, const DVec2& position_px) {
  const DVec2 offset = position_px - view.axis_px;
  return {offset.x, -offset.y, -view.focal_px};
}

double band_centre_cpd(int band, double pixels_per_degree) {
  const double nyquist = 0.5 * pixels_per_degree;
  return band == 0 ? nyquist : kFirstReducedBand * std::exp2(1 - band) * nyquist;
}

/// sum_p (S L)^2 over one band.
double visible_energy(const Plane<float>& band, int index, const GazedView& view,
                      Sensitivity sensitivity) {
  const double step = std::exp2(index);
  double sum = 0.0;
  for (int y = 0; y < band.height(); ++y) {
    for (int x = 0; x < band.width(); ++x) {
      double response = band(x, y);
      if (sensitivity == Sensitivity::GeislerPerry) {
        const DVec2 place{x * step + 0.5, y * step + 0.5};
        // Off the axis a pixel covers fewer degrees: cos along one direction, cos^2 along the
        // other.
        const double ppd = view.pixels_per_degree() * std::pow(view.axis_cosine(place), -1.5);
        response *= contrast_sensitivity(band_centre_cpd(index, ppd), view.eccentricity(place));
      }
      sum += response * response;
    }
  }
  return sum;
}

}  // namespace

GazedView GazedView::centred(int width_px, int height_px, double pixels_per_degree) {
  const DVec2 middle{0.5 * width_px, 0.5 * height_px};
  return {pixels_per_degree * 180.0 / std::numbers::pi, middle, middle};
}

Radians GazedView::eccentricity(const DVec2& position_px) const {
  return foveation::eccentricity(direction(*this, gaze_px), direction(*this, position_px));
}

double GazedView::axis_cosine(const DVec2& position_px) const {
  const DVec2 offset = position_px - axis_px;
  return focal_px / std::sqrt(focal_px * focal_px + dot(offset, offset));
}

double GazedView::pixels_per_degree() const {
  return focal_px * std::numbers::pi / 180.0;
}

double acuity_weight(Radians eccentricity) {
  const double loss = 1.0 + kFoveaCyclesPerDegree * kAcuitySlope * Degrees{eccentricity}.value();
  return 1.0 / (loss * loss);
}

Plane<float> acuity_weights(const GazedView& view, int width_px, int height_px) {
  const bool wide = std::max(width_px, height_px) > 2.0 * kWideHalfTangent * view.focal_px;
  Plane<float> weights(width_px, height_px);
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      const DVec2 place{x + 0.5, y + 0.5};
      const double solid_angle = wide ? std::pow(view.axis_cosine(place), 3.0) : 1.0;
      weights(x, y) = static_cast<float>(acuity_weight(view.eccentricity(place)) * solid_angle);
    }
  }
  return weights;
}

double weighted_mean(const Plane<float>& values, const Plane<float>& weights) {
  const int left = (weights.width() - values.width()) / 2;
  const int top = (weights.height() - values.height()) / 2;
  MACULA_CHECK(left >= 0 && top >= 0, "weights do not cover the values");
  double sum = 0.0, total = 0.0;
  for (int y = 0; y < values.height(); ++y) {
    for (int x = 0; x < values.width(); ++x) {
      const double weight = weights(x + left, y + top);
      sum += weight * values(x, y);
      total += weight;
    }
  }
  return total > 0.0 ? sum / total : 0.0;
}

double ew_psnr_db(const Plane<Rgb>& encoded_reference, const Plane<Rgb>& encoded_test,
                  const GazedView& view) {
  MACULA_CHECK(encoded_reference.rect() == encoded_test.rect(), "pictures differ in size");
  Plane<float> squares(encoded_reference.width(), encoded_reference.height());
  std::ranges::transform(encoded_reference.pixels(), encoded_test.pixels(),
                         squares.pixels().begin(), [](const Rgb& r, const Rgb& t) {
                           const Rgb d = t - r;
                           return dot(d, d) / 3.0F;
                         });
  return db_from_mse(
      weighted_mean(squares, acuity_weights(view, squares.width(), squares.height())));
}

double cutoff_cpd(Radians eccentricity) {
  return kHalfResolutionDegrees * std::log(kInverseThreshold) /
         (kThresholdGrowth * (Degrees{eccentricity}.value() + kHalfResolutionDegrees));
}

double contrast_sensitivity(double frequency_cpd, Radians eccentricity) {
  if (frequency_cpd > cutoff_cpd(eccentricity)) return 0.0;
  return std::exp(-kThresholdGrowth * frequency_cpd * Degrees{eccentricity}.value() /
                  kHalfResolutionDegrees);
}

double gp_psnr_db(const Plane<Rgb>& encoded_reference, const Plane<Rgb>& encoded_test,
                  const GazedView& view, Sensitivity sensitivity) {
  MACULA_CHECK(encoded_reference.rect() == encoded_test.rect(), "pictures differ in size");
  if (encoded_reference.empty()) return kBestDb;
  Plane<float> difference = luma(encoded_test);
  const Plane<float> reference = luma(encoded_reference);
  std::ranges::transform(difference.pixels(), reference.pixels(), difference.pixels().begin(),
                         [](float t, float r) { return t - r; });
  const std::vector<Plane<float>> bands = laplacian_pyramid(difference, kBands);
  double error = 0.0;
  for (int b = 0; b <= kBands; ++b) {
    // A sample of band b stands for 4^b pixels.
    error +=
        std::exp2(2 * b) * visible_energy(bands[static_cast<std::size_t>(b)], b, view, sensitivity);
  }
  return db_from_mse(error / static_cast<double>(difference.size()));
}

}  // namespace macula::metrics
