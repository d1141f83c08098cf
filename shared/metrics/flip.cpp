#include "shared/metrics/flip.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "shared/metrics/convolution.h"
#include "shared/metrics/flip_color.h"

namespace macula::metrics {
namespace {

// Constants of the 2020 paper.
constexpr float kColorExponent = 0.7F;          // q_c
constexpr float kFeatureExponent = 0.5F;        // q_f
constexpr float kKnee = 0.4F;                   // p_c: share of the largest colour difference ...
constexpr float kKneeValue = 0.95F;             // p_t: ... that maps to this
constexpr double kFeatureWidthDegrees = 0.082;  // w: the finest edge people see
constexpr double kLumaFalloff = 0.0047, kRedGreenFalloff = 0.0053;  // b of exp(-pi^2 x^2 / b)
struct BlueYellowGaussian {
  double amplitude, falloff;
};
constexpr BlueYellowGaussian kBlueYellow[2] = {{34.1, 0.04}, {13.5, 0.025}};

/// Luminance, red-green and blue-yellow opponents: Y, X - Y, Y - Z relative to white. The factors
/// 116, 500 and 200 of YCxCz stand before and after a linear filter and cancel.
struct Opponent {
  Plane<float> luminance, red_green, blue_yellow;
};

Opponent opponent_from_linear(const Plane<Rgb>& linear) {
  const int width = linear.width(), height = linear.height();
  Opponent result{Plane<float>(width, height), Plane<float>(width, height),
                  Plane<float>(width, height)};
  for (std::size_t i = 0; i < linear.size(); ++i) {
    const Rgb& c = linear.data()[i];
    const RelativeXyz v = xyz_from_linear(
        {std::clamp(c.x, 0.0F, 1.0F), std::clamp(c.y, 0.0F, 1.0F), std::clamp(c.z, 0.0F, 1.0F)});
    result.luminance.data()[i] = v.y;
    result.red_green.data()[i] = v.x - v.y;
    result.blue_yellow.data()[i] = v.y - v.z;
  }
  return result;
}

/// What the eye still resolves at this distance: contrast sensitivity as Gaussians in degrees.
class ContrastFilter {
 public:
  explicit ContrastFilter(double ppd)
      : luminance_(taps(kLumaFalloff, ppd)), red_green_(taps(kRedGreenFalloff, ppd)) {
    // exp(-pi^2 x^2 / b) summed over the plane weighs each blue-yellow Gaussian by its amplitude
    // times (sum of its one-dimensional samples)^2.
    double weights[2] = {};
    for (int i = 0; i < 2; ++i) {
      const auto [amplitude, falloff] = kBlueYellow[i];
      const double sum = sample_sum(falloff, ppd);
      weights[i] = amplitude * std::sqrt(std::numbers::pi / falloff) * sum * sum;
      blue_yellow_[i] = taps(falloff, ppd);
    }
    first_share_ = static_cast<float>(weights[0] / (weights[0] + weights[1]));
  }

  Opponent operator()(const Opponent& in) const {
    Opponent out{filter_separable(in.luminance, luminance_, luminance_),
                 filter_separable(in.red_green, red_green_, red_green_),
                 filter_separable(in.blue_yellow, blue_yellow_[0], blue_yellow_[0])};
    const Plane<float> second = filter_separable(in.blue_yellow, blue_yellow_[1], blue_yellow_[1]);
    for (std::size_t i = 0; i < second.size(); ++i) {
      float& first = out.blue_yellow.data()[i];
      first = first_share_ * first + (1.0F - first_share_) * second.data()[i];
    }
    return out;
  }

 private:
  static int radius(double ppd) {
    const double widest = std::sqrt(kBlueYellow[0].falloff / 2.0) / std::numbers::pi;
    return static_cast<int>(std::ceil(3.0 * widest * ppd));
  }
  static double sigma_px(double falloff, double ppd) {
    return ppd * std::sqrt(falloff / 2.0) / std::numbers::pi;
  }
  static Taps<float> taps(double falloff, double ppd) {
    return gaussian_taps<float>(sigma_px(falloff, ppd), radius(ppd));
  }
  static double sample_sum(double falloff, double ppd) {
    const double sigma = sigma_px(falloff, ppd);
    double sum = 0.0;
    for (int x = -radius(ppd); x <= radius(ppd); ++x)
      sum += std::exp(-0.5 * x * x / (sigma * sigma));
    return sum;
  }

  Taps<float> luminance_, red_green_, blue_yellow_[2];
  float first_share_ = 1.0F;
};

HuntLab perceived(const Opponent& filtered, std::size_t i) {
  const float y = filtered.luminance.data()[i];
  const Rgb linear =
      linear_from_xyz({filtered.red_green.data()[i] + y, y, y - filtered.blue_yellow.data()[i]});
  return hunt_lab_from_xyz(
      xyz_from_linear({std::clamp(linear.x, 0.0F, 1.0F), std::clamp(linear.y, 0.0F, 1.0F),
                       std::clamp(linear.z, 0.0F, 1.0F)}));
}

/// HyAB (Abasi et al. 2020): city-block in lightness, Euclidean in chroma.
float hyab(const HuntLab& p, const HuntLab& q) {
  const float da = p.a - q.a, db = p.b - q.b;
  return std::abs(p.l - q.l) + std::sqrt(da * da + db * db);
}

/// The largest colour difference of the sRGB gamut, green against blue, raised to q_c: 41.276.
float largest_color_difference() {
  const HuntLab green = hunt_lab_from_xyz(xyz_from_linear({0.0F, 1.0F, 0.0F}));
  const HuntLab blue = hunt_lab_from_xyz(xyz_from_linear({0.0F, 0.0F, 1.0F}));
  return std::pow(hyab(green, blue), kColorExponent);
}

/// Small differences get most of [0, 1], the rest is compressed above the knee.
float redistribute(float difference, float largest) {
  const float knee = kKnee * largest;
  return difference < knee
             ? difference * kKneeValue / knee
             : kKneeValue + (difference - knee) / (largest - knee) * (1.0F - kKneeValue);
}

Plane<float> color_difference(const Opponent& reference, const Opponent& test, double ppd) {
  const ContrastFilter filter(ppd);
  const Opponent r = filter(reference), t = filter(test);
  const float largest = largest_color_difference();
  Plane<float> result(r.luminance.width(), r.luminance.height());
  for (std::size_t i = 0; i < result.size(); ++i) {
    result.data()[i] = hyab(perceived(r, i), perceived(t, i));
  }
  for (float& value : result.pixels()) {
    value = redistribute(std::pow(value, kColorExponent), largest);
  }
  return result;
}

/// factor * exp(exponent)
struct Weight {
  double factor = 0.0, exponent = 0.0;
};

/// Positive and negative weights each scaled to a sum of one, so that a step and a spot of full
/// contrast both answer with about 1. Where a pixel is wide, all of one sign may be smaller than
/// any number is: their ratios are not, and pictures of less than a pixel a degree have features
/// too.
Taps<float> balanced(const std::vector<Weight>& weights) {
  constexpr double kNone = -std::numeric_limits<double>::infinity();
  double most[2] = {kNone, kNone}, sum[2] = {};
  const auto sign = [](const Weight& w) { return w.factor > 0.0 ? 1 : 0; };
  const auto value = [&](const Weight& w) {
    return w.factor == 0.0 ? 0.0 : w.factor * std::exp(w.exponent - most[sign(w)]);
  };
  for (const Weight& w : weights)
    if (w.factor != 0.0) most[sign(w)] = std::max(most[sign(w)], w.exponent);
  for (const Weight& w : weights) sum[sign(w)] += std::abs(value(w));
  Taps<float> taps;
  for (const Weight& w : weights)
    taps.push_back(w.factor == 0.0 ? 0.0F : static_cast<float>(value(w) / sum[sign(w)]));
  return taps;
}

/// First and second Gaussian derivatives of luminance: edges and points.
class FeatureDetector {
 public:
  struct Features {
    Plane<float> edge, point;
  };

  explicit FeatureDetector(double ppd) {
    const double sigma = 0.5 * kFeatureWidthDegrees * ppd;
    const int radius = static_cast<int>(std::ceil(3.0 * sigma));
    std::vector<Weight> first, second;
    for (int x = -radius; x <= radius; ++x) {
      const double exponent = -0.5 * x * x / (sigma * sigma);
      first.push_back({static_cast<double>(-x), exponent});
      second.push_back({x * x / (sigma * sigma) - 1.0, exponent});
    }
    smooth_ = gaussian_taps<float>(sigma, radius);
    first_ = balanced(first);
    second_ = balanced(second);
  }

  Features operator()(const Plane<float>& luminance) const {
    return {magnitude(luminance, first_), magnitude(luminance, second_)};
  }

 private:
  Plane<float> magnitude(const Plane<float>& in, const Taps<float>& derivative) const {
    Plane<float> result = filter_separable(in, derivative, smooth_);
    const Plane<float> down = filter_separable(in, smooth_, derivative);
    for (std::size_t i = 0; i < result.size(); ++i) {
      float& across = result.data()[i];
      across = std::sqrt(across * across + down.data()[i] * down.data()[i]);
    }
    return result;
  }

  Taps<float> smooth_, first_, second_;
};

Plane<float> feature_difference(const Plane<float>& reference, const Plane<float>& test,
                                double ppd) {
  const FeatureDetector detect(ppd);
  const auto r = detect(reference), t = detect(test);
  Plane<float> result(reference.width(), reference.height());
  for (std::size_t i = 0; i < result.size(); ++i) {
    const float edge = std::abs(r.edge.data()[i] - t.edge.data()[i]);
    const float point = std::abs(r.point.data()[i] - t.point.data()[i]);
    result.data()[i] = std::max(edge, point) / std::numbers::sqrt2_v<float>;
  }
  static_assert(kFeatureExponent == 0.5F);
  for (float& value : result.pixels()) value = std::sqrt(value);
  return result;
}

}  // namespace

Plane<float> flip_map(const Plane<Rgb>& reference, const Plane<Rgb>& test,
                      double pixels_per_degree) {
  MACULA_CHECK(reference.rect() == test.rect(), "pictures differ in size");
  MACULA_CHECK(pixels_per_degree > 0.0 && pixels_per_degree <= 1000.0, "pixels per degree");
  const Opponent r = opponent_from_linear(reference), t = opponent_from_linear(test);
  Plane<float> map = color_difference(r, t, pixels_per_degree);
  const Plane<float> feature = feature_difference(r.luminance, t.luminance, pixels_per_degree);
  for (std::size_t i = 0; i < map.size(); ++i) {
    map.data()[i] = std::pow(map.data()[i], 1.0F - feature.data()[i]);
  }
  return map;
}

}  // namespace macula::metrics
