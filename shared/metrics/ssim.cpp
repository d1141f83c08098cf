#include "shared/metrics/ssim.h"

#include <algorithm>

#include "shared/metrics/convolution.h"
#include "shared/metrics/error.h"

namespace macula::metrics {
namespace {

constexpr int kRadius = kSsimWindow / 2;
constexpr double kSigma_px = 1.5;

// Double throughout: the variances are differences of nearly equal squares, E[x^2] - E[x]^2.
Plane<double> local_mean(const Plane<double>& in) {
  static const Taps<double> window = gaussian_taps<double>(kSigma_px, kRadius);
  return filter_separable(in, window, window);
}

Plane<double> local_mean_of_product(const Plane<float>& a, const Plane<float>& b) {
  Plane<double> product(a.width(), a.height());
  std::ranges::transform(a.pixels(), b.pixels(), product.pixels().begin(),
                         [](double x, double y) { return x * y; });
  return local_mean(product);
}

Plane<double> widened(const Plane<float>& in) {
  Plane<double> result(in.width(), in.height());
  std::ranges::copy(in.pixels(), result.pixels().begin());
  return result;
}

Plane<float> channel(const Plane<Rgb>& picture, int index) {
  Plane<float> result(picture.width(), picture.height());
  std::ranges::transform(picture.pixels(), result.pixels().begin(),
                         [index](const Rgb& c) { return c[index]; });
  return result;
}

/// Wang et al. 2004, Eq. 13, from first and second moments.
class Similarity {
 public:
  explicit Similarity(double peak)
      : c1_((0.01 * peak) * (0.01 * peak)), c2_((0.03 * peak) * (0.03 * peak)) {}

  double operator()(double r, double t, double rr, double tt, double rt) const {
    const double variances = (rr - r * r) + (tt - t * t);
    const double covariance = rt - r * t;
    return (2.0 * r * t + c1_) * (2.0 * covariance + c2_) /
           ((r * r + t * t + c1_) * (variances + c2_));
  }

 private:
  double c1_, c2_;
};

}  // namespace

Plane<float> ssim_map(const Plane<float>& reference, const Plane<float>& test, double peak) {
  MACULA_CHECK(reference.rect() == test.rect(), "pictures differ in size");
  MACULA_CHECK(reference.width() >= kSsimWindow && reference.height() >= kSsimWindow,
               "SSIM needs at least 11x11 pixels");
  const Plane<double> r = local_mean(widened(reference)), t = local_mean(widened(test));
  const Plane<double> rr = local_mean_of_product(reference, reference);
  const Plane<double> tt = local_mean_of_product(test, test);
  const Plane<double> rt = local_mean_of_product(reference, test);

  const Similarity similarity(peak);
  Plane<float> map(reference.width() - 2 * kRadius, reference.height() - 2 * kRadius);
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      const int sx = x + kRadius, sy = y + kRadius;
      map(x, y) =
          static_cast<float>(similarity(r(sx, sy), t(sx, sy), rr(sx, sy), tt(sx, sy), rt(sx, sy)));
    }
  }
  return map;
}

double ssim(const Plane<float>& reference, const Plane<float>& test, double peak) {
  const Plane<float> map = ssim_map(reference, test, peak);
  double sum = 0.0;
  for (const float value : map.pixels()) sum += value;
  return sum / static_cast<double>(map.size());
}

double ssim_luma(const Plane<Rgb>& encoded_reference, const Plane<Rgb>& encoded_test) {
  return ssim(luma(encoded_reference), luma(encoded_test));
}

double ssim_rgb(const Plane<Rgb>& encoded_reference, const Plane<Rgb>& encoded_test) {
  double sum = 0.0;
  for (int c = 0; c < 3; ++c) sum += ssim(channel(encoded_reference, c), channel(encoded_test, c));
  return sum / 3.0;
}

}  // namespace macula::metrics
