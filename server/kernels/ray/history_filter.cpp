#include "server/kernels/ray/history_filter.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/sampling/sample.h"

namespace macula::kernels::ray {
namespace {

constexpr int kBicubicTaps = 16;

/// Catmull-Rom weights of four taps around a fraction in [0, 1); exact at 0.
std::array<float, 4> bicubic_weights(float t) {
  const float t2 = t * t, t3 = t2 * t;
  return {0.5F * (-t + 2.0F * t2 - t3), 0.5F * (2.0F - 5.0F * t2 + 3.0F * t3),
          0.5F * (t + 4.0F * t2 - 3.0F * t3), 0.5F * (t3 - t2)};
}

/// Left or upper of the two cells whose centres surround a place, and the fraction between them.
struct Between {
  int first;
  float fraction;

  explicit Between(float place) : first(0), fraction(0.0F) {
    const float below = std::floor(place - 0.5F);
    first = static_cast<int>(below);
    fraction = place - 0.5F - below;
  }
};

/// Shares of unknown cells go to the known ones; without any share they take equal ones.
void normalise(Taps& taps) {
  float sum = 0.0F;
  for (int i = 0; i < taps.count; ++i) sum += taps.tap[i].weight;
  constexpr float kLeastSum = 1e-3F;  // below it the known cells are mere rounding of the place
  for (int i = 0; i < taps.count; ++i) {
    float& share = taps.tap[i].weight;
    share = sum > kLeastSum ? share / sum : 1.0F / static_cast<float>(taps.count);
  }
}

}  // namespace

Taps HistoryTaps::at(int x, int y, const Vec2& place) const {
  if (filter_ == HistoryFilter::NormalTaps) return normal(x, y, place);
  if (filter_ == HistoryFilter::Bicubic) return bicubic(place);
  return bilinear(place);
}

void HistoryTaps::add_known(int x, int y, float weight, Taps& taps) const {
  x = std::clamp(x, 0, then_.color.width() - 1);
  y = std::clamp(y, 0, then_.color.height() - 1);
  if (then_.remembers(x, y)) taps.add(x, y, weight);
}

Taps HistoryTaps::bilinear(const Vec2& place) const {
  const Between x(place.x), y(place.y);
  const float tx = x.fraction, ty = y.fraction;
  Taps taps;
  add_known(x.first, y.first, (1.0F - tx) * (1.0F - ty), taps);
  add_known(x.first + 1, y.first, tx * (1.0F - ty), taps);
  add_known(x.first, y.first + 1, (1.0F - tx) * ty, taps);
  add_known(x.first + 1, y.first + 1, tx * ty, taps);
  if (taps.count < 4) normalise(taps);
  return taps;
}

Taps HistoryTaps::bicubic(const Vec2& place) const {
  const Between x(place.x), y(place.y);
  const auto wx = bicubic_weights(x.fraction), wy = bicubic_weights(y.fraction);
  Taps taps;
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 4; ++i) {
      add_known(x.first - 1 + i, y.first - 1 + j, wx[i] * wy[j], taps);
    }
  }
  return taps.count == kBicubicTaps ? taps : bilinear(place);
}

/// Four cells, each coordinate normally distributed by half a cell (Box and Muller 1958).
Taps HistoryTaps::normal(int x, int y, const Vec2& place) const {
  constexpr std::uint64_t kStream = 0x7A95U;
  const sampling::SampleKey key(kStream, frame_, view_.grid.cell_key(x, y));
  Taps taps;
  for (std::uint32_t k = 0; k < 4; ++k) {
    const Vec2 u = sampling::sample_2d(key, 2 * k);
    const float radius = 0.5F * std::sqrt(-2.0F * std::log(1.0F - u.x));
    const float phi = 2.0F * std::numbers::pi_v<float> * u.y;
    add_known(static_cast<int>(std::floor(place.x + radius * std::cos(phi))),
              static_cast<int>(std::floor(place.y + radius * std::sin(phi))), 0.25F, taps);
  }
  if (taps.count == 0) taps.add(static_cast<int>(place.x), static_cast<int>(place.y), 1.0F);
  normalise(taps);
  return taps;
}

Texel filtered(const Taps& taps, const Plane<Texel>& plane) {
  Texel sum;
  for (int i = 0; i < taps.count; ++i) {
    const Texel& value = plane(taps.tap[i].x, taps.tap[i].y);
    const float weight = taps.tap[i].weight;
    sum.r += weight * value.r, sum.g += weight * value.g, sum.b += weight * value.b;
  }
  if (taps.count < kBicubicTaps) return sum;
  Rgb low = plane(taps.tap[5].x, taps.tap[5].y).rgb(), high = low;
  for (const int i : {6, 9, 10}) {
    const Rgb value = plane(taps.tap[i].x, taps.tap[i].y).rgb();
    low = glm::min(low, value), high = glm::max(high, value);
  }
  return Texel(glm::clamp(sum.rgb(), low, high));
}

}  // namespace macula::kernels::ray
