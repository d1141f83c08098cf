#include "server/filters/filters.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace macula::filters {
namespace {

template <class F>
auto filled(int width, int height, const F& f) {
  Plane<decltype(f(0, 0))> plane(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) plane(x, y) = f(x, y);
  }
  return plane;
}

TEST(Filters, SobelIsEightOnARampAndFourBesideAStep) {
  const auto ramp = sobel_length(filled(9, 7, [](int x, int) { return static_cast<float>(x); }));
  for (int y = 0; y < 7; ++y) {
    for (int x = 1; x < 8; ++x) EXPECT_FLOAT_EQ(ramp(x, y), 8.0F);
    EXPECT_FLOAT_EQ(ramp(0, y), 4.0F) << "the border repeats";
  }
  const auto step = sobel_length(filled(8, 8, [](int, int y) { return y < 4 ? 0.0F : 1.0F; }));
  for (int y = 0; y < 8; ++y) EXPECT_FLOAT_EQ(step(5, y), y == 3 || y == 4 ? 4.0F : 0.0F);
}

TEST(Filters, SobelOfAVectorAddsItsChannelsSquares) {
  const auto length = sobel_length(filled(8, 8, [](int x, int y) {
    return Vec3{static_cast<float>(2 * x), static_cast<float>(y), 7.0F};
  }));
  EXPECT_FLOAT_EQ(length(4, 4), 8.0F * std::sqrt(5.0F));
}

TEST(Filters, TheMeanOfAPointIsTheGaussianItself) {
  const auto spread =
      gaussian_mean(filled(11, 11, [](int x, int y) { return x == 5 && y == 5 ? 1.0F : 0.0F; }), 1);
  double sum = 0.0, weights = 0.0;
  for (int k = -2; k <= 2; ++k) weights += std::exp(-0.5 * k * k);
  for (int y = 0; y < 11; ++y) {
    for (int x = 0; x < 11; ++x) {
      const int dx = x - 5, dy = y - 5;
      const bool within = std::abs(dx) <= 2 && std::abs(dy) <= 2;
      const double wanted = within ? std::exp(-0.5 * (dx * dx + dy * dy)) / (weights * weights) : 0;
      EXPECT_NEAR(spread(x, y), wanted, 1e-6);
      sum += static_cast<double>(spread(x, y));
    }
  }
  EXPECT_NEAR(sum, 1.0, 1e-6);
}

TEST(Filters, TheMedianLosesSpecklesAndKeepsAStraightEdge) {
  const auto plane = filled(16, 16, [](int x, int y) {
    return x == 3 && y % 4 == 0 ? 100.0F : x < 8 ? 1.0F : 2.0F;
  });
  const auto median = median_of_25(plane);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) EXPECT_EQ(median(x, y), x < 8 ? 1.0F : 2.0F);
  }
}

TEST(Filters, TheBilateralMeanSmoothsWithinAndStopsAtEdges) {
  const auto plane = filled(20, 20, [](int x, int y) {
    return (x < 10 ? 0.0F : 8.0F) + ((x + y) % 2 == 0 ? 0.1F : -0.1F);
  });
  const auto mean = bilateral_mean(plane, 1.5F, 1.0F);
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 20; ++x) EXPECT_NEAR(mean(x, y), x < 10 ? 0.0F : 8.0F, 0.02F);
  }
  const auto flat = bilateral_mean(Plane<float>(6, 3, 4.0F), 1.5F, 1.0F);
  for (const float value : flat.pixels()) EXPECT_EQ(value, 4.0F);
}

TEST(Filters, AFlatPlaneHasNoBandAndIsItsOwnResidual) {
  for (const int side : {1, 2, 5, 32}) {
    const auto levels = laplacian_levels(Plane<float>(side, side, 3.0F));
    for (const float band : levels.finest.pixels()) EXPECT_NEAR(band, 0.0F, 1e-5F);
    for (const float rest : levels.residual.pixels()) EXPECT_NEAR(rest, 3.0F, 1e-5F);
  }
}

/// The binomial of five lets cos^4(w / 2) of a wave of w radians a pixel through, once to reduce
/// and once to expand.
TEST(Filters, TheFinestBandHoldsTheFinestWaves) {
  const auto energy = [](double period_px) {
    const auto wave = filled(64, 64, [&](int x, int) {
      return static_cast<float>(std::cos(2.0 * std::numbers::pi * x / period_px));
    });
    double band = 0.0, all = 0.0;
    const auto levels = laplacian_levels(wave);
    for (int x = 16; x < 48; ++x) {
      band += std::pow(static_cast<double>(levels.finest(x, 32)), 2);
      all += std::pow(static_cast<double>(wave(x, 32)), 2);
    }
    return band / all;
  };
  EXPECT_NEAR(energy(2.0), 1.0, 1e-3);
  const double passed = std::pow(std::cos(std::numbers::pi / 32.0), 8);
  EXPECT_NEAR(energy(32.0), std::pow(1.0 - passed, 2), 1e-4);
}

TEST(Filters, AResizedRampNearlyStaysOneAndAFlatPlaneStaysFlat) {
  const auto ramp = filled(8, 8, [](int x, int y) { return static_cast<float>(x + 2 * y); });
  const auto large = resize_bicubic(ramp, 32, 24);
  for (int y = 6; y < 18; ++y) {
    for (int x = 8; x < 24; ++x) {
      const double wanted = (x + 0.5) / 4.0 - 0.5 + 2.0 * ((y + 0.5) / 3.0 - 0.5);
      EXPECT_NEAR(large(x, y), wanted, 0.2) << "OpenCV's spline has a = -0.75: ramps ripple";
    }
  }
  const auto flat = resize_bicubic(Plane<float>(3, 2, 0.7F), 24, 16);
  for (const float value : flat.pixels()) EXPECT_NEAR(value, 0.7F, 1e-5F);
}

}  // namespace
}  // namespace macula::filters
