// HDR-FLIP: LDR-FLIP under every exposure that shows something, and per pixel the worst of them.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>
#include <vector>

#include "shared/metrics/flip.h"
#include "shared/metrics/flip_color.h"

namespace macula::metrics {
namespace {

// The ACES fit of Narkowicz (2015) with the exposure factor 0.6 folded in, as the 2021 paper has
// it: (a x^2 + b x) / (c x^2 + d x + e).
constexpr double kA = 0.36 * 2.51, kB = 0.6 * 0.03;
constexpr double kC = 0.36 * 2.43, kD = 0.6 * 0.59, kE = 0.14;
constexpr double kBrightest = 0.85;  // the tone-mapped value an exposure brings its luminance to
/// Threads beyond this bring little: each holds about 20 planes.
constexpr int kMostThreads = 4;

float tone_mapped(float radiance) {
  constexpr auto a = static_cast<float>(kA), b = static_cast<float>(kB), c = static_cast<float>(kC),
                 d = static_cast<float>(kD), e = static_cast<float>(kE);
  const float x = std::max(radiance, 0.0F);
  return std::clamp((a * x + b) * x / ((c * x + d) * x + e), 0.0F, 1.0F);
}

/// The larger root of (a - t c) x^2 + (b - t d) x - t e = 0 with t = kBrightest.
double radiance_that_maps_to_brightest() {
  const double p = (kB - kBrightest * kD) / (kA - kBrightest * kC);
  const double q = -kBrightest * kE / (kA - kBrightest * kC);
  return -0.5 * p + std::sqrt(0.25 * p * p - q);
}

Plane<Rgb> exposed(const Plane<Rgb>& radiance, double ev) {
  const float factor = static_cast<float>(std::exp2(ev));
  Plane<Rgb> result(radiance.width(), radiance.height());
  std::ranges::transform(radiance.pixels(), result.pixels().begin(), [factor](const Rgb& c) {
    return Rgb{tone_mapped(factor * c.x), tone_mapped(factor * c.y), tone_mapped(factor * c.z)};
  });
  return result;
}

/// Of a non-empty list; the upper of the two middle values where their number is even.
double median(std::vector<float>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace

ExposureRange automatic_exposures(const Plane<Rgb>& reference) {
  std::vector<float> luminances;
  luminances.reserve(reference.size());
  for (const Rgb& c : reference.pixels()) {
    luminances.push_back(std::max(xyz_from_linear(c).y, 0.0F));
  }
  const auto dark = [](float y) { return y <= 0.0F; };
  if (std::ranges::all_of(luminances, dark)) return {};
  const double brightest = std::ranges::max(luminances);
  double middle = median(luminances);
  if (middle <= 0.0) {
    std::erase_if(luminances, dark);
    middle = median(luminances);
  }
  const double target = radiance_that_maps_to_brightest();
  ExposureRange range{std::log2(target / brightest), std::log2(target / middle), 2};
  range.count = std::max(2, static_cast<int>(std::ceil(range.stop_ev - range.start_ev)));
  return range;
}

HdrFlip hdr_flip(const Plane<Rgb>& reference, const Plane<Rgb>& test, double pixels_per_degree) {
  const ExposureRange range = automatic_exposures(reference);
  const int threads = std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1,
                                 std::min(kMostThreads, range.count));
  std::vector<Plane<float>> worst(static_cast<std::size_t>(threads),
                                  Plane<float>(reference.width(), reference.height(), 0.0F));
  std::atomic<int> next{0};
  const auto keep_worst = [&](Plane<float>& mine) {
    for (int i = next++; i < range.count; i = next++) {
      const Plane<float> map =
          flip_map(exposed(reference, range.ev(i)), exposed(test, range.ev(i)), pixels_per_degree);
      std::ranges::transform(map.pixels(), mine.pixels(), mine.pixels().begin(),
                             [](float a, float b) { return std::max(a, b); });
    }
  };
  {
    std::vector<std::jthread> workers;
    for (std::size_t i = 1; i < worst.size(); ++i)
      workers.emplace_back(keep_worst, std::ref(worst[i]));
    keep_worst(worst[0]);
  }
  for (std::size_t i = 1; i < worst.size(); ++i) {
    std::ranges::transform(worst[i].pixels(), worst[0].pixels(), worst[0].pixels().begin(),
                           [](float a, float b) { return std::max(a, b); });
  }
  return {std::move(worst[0]), range};
}

}  // namespace macula::metrics
