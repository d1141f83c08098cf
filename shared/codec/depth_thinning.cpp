#include "shared/codec/depth_thinning.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace macula::codec {
namespace {

/// Neighbours whose inverse depths differ by more than this share lie on different surfaces.
constexpr float kOneSurface = 0.1F;

/// Where a cell lies between samples of one axis.
struct Place {
  int low = 0, high = 0;
  float share = 0.0F;  ///< of `high`
};

std::vector<Place> places(int cells, int samples, int divisor) {
  std::vector<Place> along;
  for (int cell = 0; cell < cells; ++cell) {
    const float at =
        (static_cast<float>(cell) - static_cast<float>(divisor / 2)) / static_cast<float>(divisor);
    const int low = static_cast<int>(std::floor(at));
    along.push_back({std::clamp(low, 0, samples - 1), std::clamp(low + 1, 0, samples - 1),
                     at - static_cast<float>(low)});
  }
  return along;
}

float between(const image::Plane<float>& samples, const Place& x, const Place& y) {
  const float a = samples(x.low, y.low), b = samples(x.high, y.low);
  const float c = samples(x.low, y.high), d = samples(x.high, y.high);
  const auto [least, most] = std::minmax({a, b, c, d});
  if (most - least <= kOneSurface * most && least > 0.0F) {
    return std::lerp(std::lerp(a, b, x.share), std::lerp(c, d, x.share), y.share);
  }
  return samples(x.share < 0.5F ? x.low : x.high, y.share < 0.5F ? y.low : y.high);
}

}  // namespace

image::Plane<float> thin(const image::Plane<float>& whole, int divisor) {
  image::Plane<float> samples(thinned(whole.width(), divisor), thinned(whole.height(), divisor));
  for (int y = 0; y < samples.height(); ++y) {
    const int from_y = std::min(y * divisor + divisor / 2, whole.height() - 1);
    for (int x = 0; x < samples.width(); ++x) {
      samples(x, y) = whole(std::min(x * divisor + divisor / 2, whole.width() - 1), from_y);
    }
  }
  return samples;
}

void spread(const image::Plane<float>& samples, int divisor, image::Plane<float>& whole) {
  const auto across = places(whole.width(), samples.width(), divisor);
  const auto down = places(whole.height(), samples.height(), divisor);
  for (int y = 0; y < whole.height(); ++y) {
    for (int x = 0; x < whole.width(); ++x) whole(x, y) = between(samples, across[x], down[y]);
  }
}

}  // namespace macula::codec
