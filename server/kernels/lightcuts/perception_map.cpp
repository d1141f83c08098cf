#include "server/kernels/lightcuts/perception_map.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "server/filters/filters.h"
#include "shared/base/check.h"

namespace macula::kernels::lightcuts {
namespace {

// A full edge is the greatest step between neighbours: albedo changes by 1, a normal that turns
// back by 2. Half of that for a full edge would spend most samples on textures outside the fovea.
constexpr float kNormalScale = 1.0F / 8.0F;
constexpr float kAlbedoScale = 1.0F / 4.0F;
/// A change from rest to 30 degrees a second, where pursuit begins to fail, is a full edge.
constexpr float kSpeedScale = 1.0F / (4.0F * 30.0F);
/// Least local mean that contrast is told against (Eq. 3's epsilon), linear luminance.
constexpr float kLeastMean = 0.01F;
constexpr float kGaussianSigma_px = 1.0F;
/// Squares and sums of a filter's few values stay below the largest float.
constexpr float kLargestInput = 1e18F;

float cleaned(float value, std::uint64_t& not_finite) {
  if (!std::isfinite(value)) {
    ++not_finite;
    return 0.0F;
  }
  return std::clamp(value, -kLargestInput, kLargestInput);
}
Vec3 cleaned(const Vec3& value, std::uint64_t& not_finite) {
  const float x = cleaned(value.x, not_finite), y = cleaned(value.y, not_finite);
  return {x, y, cleaned(value.z, not_finite)};
}
template <class T>
Plane<T> cleaned(Plane<T> plane, std::uint64_t& not_finite) {
  for (T& value : plane.pixels()) value = cleaned(value, not_finite);
  return plane;
}

void raise(std::span<float> to, std::span<const float> from, float scale) {
  for (std::size_t i = 0; i < to.size(); ++i) {
    to[i] = std::max(to[i], std::clamp(scale * from[i], 0.0F, 1.0F));
  }
}

template <class T>
void raise_at_edges(Plane<float>& feature, const Plane<T>& plane, float scale,
                    std::uint64_t& not_finite) {
  if (plane.empty()) return;
  MACULA_CHECK(plane.rect() == feature.rect(), "planes of one view");
  const Plane<float> edges = filters::sobel_length(cleaned(plane, not_finite));
  raise(feature.pixels(), edges.pixels(), scale);
}

/// What a few dozen light samples a pixel leave of chance would pass for contrast, above all in the
/// dark: lone outliers go first, then differences below kNoise stops.
Plane<float> without_noise(Plane<float> luminance) {
  constexpr float kNoise = 1.0F, kReach_px = 1.5F;
  for (float& value : luminance.pixels()) value = std::log2(std::max(value, 0.0F) + kLeastMean);
  luminance = filters::bilateral_mean(filters::median_of_25(luminance), kReach_px, kNoise);
  for (float& value : luminance.pixels()) value = std::exp2(value) - kLeastMean;
  return luminance;
}

/// Contrast: the finest band over the local mean.
Plane<float> fine_contrast(const Plane<float>& luminance) {
  auto [finest, residual] = filters::laplacian_levels(without_noise(luminance));
  for (std::size_t i = 0; i < finest.size(); ++i) {
    const float mean = std::max(residual.pixels()[i], 0.0F);
    finest.pixels()[i] = std::min(std::abs(finest.pixels()[i]) / (mean + kLeastMean), 1.0F);
  }
  return finest;
}

/// Eq. 6 and 7 solved for the Gaussian's width, infinite where M <= alpha.
Plane<float> printed_widths(const PerceptionMap& made, float alpha) {
  constexpr float kMargin = 1e-3F;
  const Plane<float> spatial_mean = filters::gaussian_mean(made.spatial, kGaussianSigma_px);
  const Plane<float> luminance_mean = filters::gaussian_mean(made.luminance, kGaussianSigma_px);
  Plane<float> widths(made.spatial.width(), made.spatial.height());
  for (std::size_t i = 0; i < widths.size(); ++i) {
    const float st = made.spatial.pixels()[i], l = made.luminance.pixels()[i];
    const float ds = st - spatial_mean.pixels()[i], dl = l - luminance_mean.pixels()[i];
    const float above = std::max(st, l) - alpha;
    const float kept = std::clamp(above, kMargin, 1.0F - kMargin);
    widths.pixels()[i] =
        above > 0.0F ? std::sqrt((ds * ds + dl * dl) / (-2.0F * std::log(kept))) : INFINITY;
  }
  return widths;
}

/// Eq. 8.
Plane<float> printed_map(const PerceptionMap& made, float alpha) {
  Plane<float> map = printed_widths(made, alpha);
  float least = INFINITY, most = 0.0F;
  for (const float width : map.pixels()) {
    if (!std::isfinite(width)) continue;
    least = std::min(least, width), most = std::max(most, width);
  }
  for (std::size_t i = 0; i < map.size(); ++i) {
    float& value = map.pixels()[i];
    const float feature = std::max(made.spatial.pixels()[i], made.luminance.pixels()[i]);
    value = most > least ? 1.0F - (std::min(value, most) - least) / (most - least) : feature;
  }
  return map;
}

double mean_of(const Plane<float>& map, const NodeRange& range, double scale,
               Plane<std::uint16_t>* nodes) {
  const auto most = static_cast<double>(range.most);
  double sum = 0.0;
  for (std::size_t i = 0; i < map.size(); ++i) {
    const double wanted = scale * most * static_cast<double>(map.pixels()[i]);
    const double held = std::clamp(wanted, static_cast<double>(range.least), most);
    const int count = static_cast<int>(held + 0.5);  // std::round is a call
    if (nodes != nullptr) nodes->pixels()[i] = static_cast<std::uint16_t>(count);
    sum += count;
  }
  return map.empty() ? 0.0 : sum / static_cast<double>(map.size());
}

/// The mean never falls in the scale: halving the interval finds it.
double scale_for(const Plane<float>& map, const NodeRange& range, double mean_wanted) {
  double low = 0.0, high = 1.0;
  constexpr double kLargest = 0x1p20;
  while (high < kLargest && mean_of(map, range, high, nullptr) < mean_wanted) high *= 2.0;
  constexpr int kHalvings = 40;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (mean_of(map, range, middle, nullptr) < mean_wanted ? low : high) = middle;
  }
  return high;
}

}  // namespace

float share_of_samples(float feature, const PerceptionConfig& config) {
  MACULA_DCHECK(config.mode != PerceptionMode::Printed, "needs the whole frame");
  const float m = std::clamp(feature, 0.0F, 1.0F), alpha = config.alpha;
  if (config.mode == PerceptionMode::Stengel) return m;
  if (m <= std::max(alpha, 0.0F)) return 0.0F;
  if (alpha <= 0.0F) return config.mode == PerceptionMode::Attenuation ? 1.0F : m;
  if (config.mode == PerceptionMode::Difference) return (m - alpha) / (1.0F - alpha);
  // M e^{-rho^2 / 2} = M - alpha; shares are told against the width for alpha / M = 1 / 40, which
  // the eye resolves wherever it resolves anything.
  constexpr float kFullRate = 0.025F;
  const float reference = std::sqrt(-2.0F * std::log1p(-kFullRate));
  const float width = std::sqrt(-2.0F * std::log1p(-alpha / m));
  return std::min(1.0F, std::pow(reference / width, config.gamma));
}

SeenContrast see_contrast(const Plane<float>& luminance, int width, int height) {
  SeenContrast seen;
  if (luminance.empty() || width == 0 || height == 0) return seen;
  const Plane<float> fine = fine_contrast(cleaned(luminance, seen.not_finite));
  seen.contrast = filters::resize_bicubic(fine, width, height);
  return seen;
}

PerceptionMap make_perception_map(const PerceptionInputs& inputs, const PerceptionConfig& config) {
  const SeenContrast seen =
      see_contrast(inputs.luminance, inputs.acuity.width(), inputs.acuity.height());
  PerceptionMap made = make_perception_map(inputs, seen, 0, config);
  made.not_finite += seen.not_finite;
  return made;
}

PerceptionMap make_perception_map(const PerceptionInputs& inputs, const SeenContrast& seen,
                                  int first, const PerceptionConfig& config) {
  MACULA_CHECK(!std::isnan(config.alpha) && config.gamma > 0.0F);
  PerceptionMap made;
  Plane<float> acuity = cleaned(inputs.acuity, made.not_finite);
  for (float& value : acuity.pixels()) value = std::clamp(value, 0.0F, 1.0F);
  made.spatial = acuity;
  raise_at_edges(made.spatial, inputs.normal, config.contrast * kNormalScale, made.not_finite);
  raise_at_edges(made.spatial, inputs.albedo, config.contrast * kAlbedoScale, made.not_finite);
  raise_at_edges(made.spatial, inputs.speed, config.contrast * kSpeedScale, made.not_finite);
  made.luminance = std::move(acuity);
  if (!seen.contrast.empty()) {
    for (int y = 0; y < made.luminance.height(); ++y)
      raise(made.luminance.row(y), seen.contrast.row(first + y), config.contrast);
  }
  if (config.mode == PerceptionMode::Printed) {
    made.map = printed_map(made, config.alpha);
    return made;
  }
  made.map = made.spatial;
  raise(made.map.pixels(), made.luminance.pixels(), 1.0F);
  for (float& value : made.map.pixels()) value = share_of_samples(value, config);
  return made;
}

NodeCounts node_counts(const Plane<float>& map, const NodeRange& range, double mean_wanted) {
  MACULA_CHECK(1 <= range.least && range.least <= range.most && range.most <= 0xFFFF);
  NodeCounts counts;
  if (mean_wanted > 0.0) counts.scale = scale_for(map, range, mean_wanted);
  counts.nodes.resize(map.width(), map.height());
  counts.mean = mean_of(map, range, counts.scale, &counts.nodes);
  return counts;
}

}  // namespace macula::kernels::lightcuts
