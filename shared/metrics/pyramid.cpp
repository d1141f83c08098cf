#include "shared/metrics/pyramid.h"

#include <algorithm>
#include <array>
#include <utility>

#include "shared/metrics/convolution.h"

namespace macula::metrics {
namespace {

constexpr std::array<float, 5> kKernel = {0.05F, 0.25F, 0.4F, 0.25F, 0.05F};
constexpr int kRadius = 2;

/// Where output sample `i` of expand() reads: the kernel taps that fall on samples that exist
/// before zeros are put between them, renormalised.
struct ExpandTaps {
  std::array<int, 3> source{};
  std::array<float, 3> weight{};
};

ExpandTaps expand_taps(int i, int source_size) {
  ExpandTaps taps;
  float sum = 0.0F;
  std::size_t used = 0;
  for (int k = -kRadius; k <= kRadius; ++k) {
    if ((i + k) % 2 != 0) continue;
    taps.source[used] = std::clamp((i + k) / 2, 0, source_size - 1);
    taps.weight[used] = kKernel[static_cast<std::size_t>(k + kRadius)];
    sum += taps.weight[used++];
  }
  for (float& weight : taps.weight) weight /= sum;
  return taps;
}

std::vector<ExpandTaps> expand_table(int size, int source_size) {
  std::vector<ExpandTaps> table;
  for (int i = 0; i < size; ++i) table.push_back(expand_taps(i, source_size));
  return table;
}

}  // namespace

Plane<float> reduce(const Plane<float>& in) {
  static const Taps<float> kernel(kKernel.begin(), kKernel.end());
  const Plane<float> smooth = filter_separable(in, kernel, kernel);
  Plane<float> result((in.width() + 1) / 2, (in.height() + 1) / 2);
  for (int y = 0; y < result.height(); ++y) {
    for (int x = 0; x < result.width(); ++x) result(x, y) = smooth(2 * x, 2 * y);
  }
  return result;
}

Plane<float> expand(const Plane<float>& in, int width, int height) {
  const auto columns = expand_table(width, in.width()), rows = expand_table(height, in.height());
  Plane<float> wide(width, in.height(), 0.0F);
  for (int y = 0; y < wide.height(); ++y) {
    for (int x = 0; x < width; ++x) {
      const ExpandTaps& taps = columns[static_cast<std::size_t>(x)];
      for (std::size_t k = 0; k < 3; ++k) wide(x, y) += taps.weight[k] * in(taps.source[k], y);
    }
  }
  Plane<float> result(width, height, 0.0F);
  for (int y = 0; y < height; ++y) {
    const ExpandTaps& taps = rows[static_cast<std::size_t>(y)];
    for (std::size_t k = 0; k < 3; ++k) {
      const auto source = wide.row(taps.source[k]);
      const auto out = result.row(y);
      for (std::size_t x = 0; x < out.size(); ++x) out[x] += taps.weight[k] * source[x];
    }
  }
  return result;
}

std::vector<Plane<float>> laplacian_pyramid(const Plane<float>& in, int bands) {
  MACULA_CHECK(bands >= 0 && !in.empty(), "a pyramid needs a picture");
  std::vector<Plane<float>> pyramid;
  Plane<float> rest = in;
  for (int b = 0; b < bands; ++b) {
    Plane<float> smaller = reduce(rest);
    const Plane<float> smooth = expand(smaller, rest.width(), rest.height());
    std::ranges::transform(rest.pixels(), smooth.pixels(), rest.pixels().begin(),
                           [](float value, float low) { return value - low; });
    pyramid.push_back(std::exchange(rest, std::move(smaller)));
  }
  pyramid.push_back(std::move(rest));
  return pyramid;
}

}  // namespace macula::metrics
