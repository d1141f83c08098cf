#include "shared/metrics/convolution.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace macula::metrics {
namespace {

/// out += weight * in.
template <class T>
void accumulate_row(T weight, const T* in, T* out, int count) {
  for (int x = 0; x < count; ++x) out[x] += weight * in[x];
}

template <class T>
Plane<T> filter_rows(const Plane<T>& in, const Taps<T>& taps) {
  Plane<T> out(in.width(), in.height(), T{0});
  if (in.empty()) return out;
  const std::size_t radius = taps.size() / 2;
  std::vector<T> padded(static_cast<std::size_t>(in.width()) + 2 * radius);
  for (int y = 0; y < in.height(); ++y) {
    const auto row = in.row(y);
    const auto inside = std::fill_n(padded.begin(), radius, row.front());
    std::fill(std::ranges::copy(row, inside).out, padded.end(), row.back());
    for (std::size_t k = 0; k < taps.size(); ++k) {
      accumulate_row(taps[k], padded.data() + k, out.row(y).data(), in.width());
    }
  }
  return out;
}

template <class T>
Plane<T> filter_columns(const Plane<T>& in, const Taps<T>& taps) {
  Plane<T> out(in.width(), in.height(), T{0});
  const int radius = static_cast<int>(taps.size() / 2);
  for (int y = 0; y < in.height(); ++y) {
    for (int k = -radius; k <= radius; ++k) {
      const int source = std::clamp(y + k, 0, in.height() - 1);
      accumulate_row(taps[static_cast<std::size_t>(k + radius)], in.row(source).data(),
                     out.row(y).data(), in.width());
    }
  }
  return out;
}

}  // namespace

template <class T>
Taps<T> gaussian_taps(double sigma_px, int radius_px) {
  std::vector<double> weights;
  for (int x = -radius_px; x <= radius_px; ++x) {
    weights.push_back(std::exp(-0.5 * x * x / (sigma_px * sigma_px)));
  }
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  Taps<T> taps;
  for (const double weight : weights) taps.push_back(static_cast<T>(weight / sum));
  return taps;
}

template <class T>
Plane<T> filter_separable(const Plane<T>& in, const Taps<T>& horizontal, const Taps<T>& vertical) {
  MACULA_CHECK(horizontal.size() % 2 == 1 && vertical.size() % 2 == 1, "a filter has a middle");
  return filter_columns(filter_rows(in, horizontal), vertical);
}

template Taps<float> gaussian_taps<float>(double, int);
template Taps<double> gaussian_taps<double>(double, int);
template Plane<float> filter_separable(const Plane<float>&, const Taps<float>&, const Taps<float>&);
template Plane<double> filter_separable(const Plane<double>&, const Taps<double>&,
                                        const Taps<double>&);

}  // namespace macula::metrics
