#include "shared/metrics/error.h"

#include <algorithm>
#include <cmath>

namespace macula::metrics {
namespace {

/// Mean over pixels and channels of term(reference value, test value).
template <class Term>
double mean_over_channels(const Plane<Rgb>& reference, const Plane<Rgb>& test, Term term) {
  MACULA_CHECK(reference.rect() == test.rect(), "pictures differ in size");
  if (reference.empty()) return 0.0;
  double sum = 0.0;
  for (int y = 0; y < reference.height(); ++y) {
    const auto r = reference.row(y), t = test.row(y);
    double row_sum = 0.0;  // rows first: the partial sums stay of one magnitude
    for (std::size_t x = 0; x < r.size(); ++x) {
      row_sum += term(r[x].x, t[x].x) + term(r[x].y, t[x].y) + term(r[x].z, t[x].z);
    }
    sum += row_sum;
  }
  return sum / (3.0 * static_cast<double>(reference.size()));
}

double squared_difference(double reference, double test) {
  return (test - reference) * (test - reference);
}

}  // namespace

double mse(const Plane<Rgb>& reference, const Plane<Rgb>& test) {
  return mean_over_channels(reference, test, squared_difference);
}

double rmse(const Plane<Rgb>& reference, const Plane<Rgb>& test) {
  return std::sqrt(mse(reference, test));
}

double relative_mse(const Plane<Rgb>& reference, const Plane<Rgb>& test, double epsilon) {
  return mean_over_channels(reference, test, [epsilon](double r, double t) {
    return squared_difference(r, t) / (r * r + epsilon);
  });
}

double db_from_mse(double mean_squared_error, double peak) {
  if (mean_squared_error <= 0.0) return kBestDb;
  // The argument order makes a NaN error come out as NaN.
  return std::min(-10.0 * std::log10(mean_squared_error / (peak * peak)), kBestDb);
}

double psnr_db(const Plane<Rgb>& encoded_reference, const Plane<Rgb>& encoded_test) {
  return db_from_mse(mse(encoded_reference, encoded_test));
}

Plane<Rgb> unit_from_8bit(const Plane<Rgb8>& encoded) {
  Plane<Rgb> unit(encoded.width(), encoded.height());
  std::ranges::transform(encoded.pixels(), unit.pixels().begin(), [](const Rgb8& c) {
    return Rgb{static_cast<float>(c.r), static_cast<float>(c.g), static_cast<float>(c.b)} / 255.0F;
  });
  return unit;
}

Plane<float> luma(const Plane<Rgb>& encoded) {
  Plane<float> result(encoded.width(), encoded.height());
  std::ranges::transform(encoded.pixels(), result.pixels().begin(),
                         [](const Rgb& c) { return 0.299F * c.x + 0.587F * c.y + 0.114F * c.z; });
  return result;
}

}  // namespace macula::metrics
