#include "server/sampling/blue_noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "server/sampling/sample.h"

namespace macula::sampling {
namespace {

constexpr int kSide = BlueNoise::kSide;

/// Power of a dither pattern at frequencies up to `highest` cycles a square, without the constant,
/// as a share of what independent pixels of the same density have: p (1 - p) each.
template <class Threshold>
double low_frequency_power(double density, int highest, Threshold&& threshold) {
  double power = 0.0;
  int frequencies = 0;
  for (int v = -highest; v <= highest; ++v) {
    for (int u = -highest; u <= highest; ++u) {
      if ((u == 0 && v == 0) || u * u + v * v > highest * highest) continue;
      std::complex<double> sum = 0.0;
      for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x)
          if (threshold(x, y) < density)
            sum += std::polar(1.0, -2.0 * std::numbers::pi * (u * x + v * y) / kSide);
      power += std::norm(sum) / BlueNoise::kCount;
      ++frequencies;
    }
  }
  return power / frequencies / (density * (1.0 - density));
}

double blue(int x, int y) {
  return BlueNoise::get().threshold(x, y, 0);
}
double white(int x, int y) {
  return sample(SampleKey(1, 0, static_cast<std::uint64_t>(y * kSide + x)), 0);
}

TEST(BlueNoise, EveryRankStandsOnce) {
  std::vector<bool> seen(BlueNoise::kCount, false);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) seen.at(BlueNoise::get().rank(x, y)) = true;
  EXPECT_EQ(std::ranges::count(seen, true), BlueNoise::kCount);
}

TEST(BlueNoise, EveryLevelSelectsItsShareOfThePixelsInEveryFrame) {
  for (const std::uint64_t frame : {std::uint64_t{0}, std::uint64_t{1}, ~std::uint64_t{0}}) {
    for (const double p : {0.0, 0.01, 0.3, 0.97, 1.0}) {
      int below = 0;
      for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) below += BlueNoise::get().threshold(x, y, frame) < p;
      EXPECT_NEAR(below, p * BlueNoise::kCount, 1.0) << "level " << p << ", frame " << frame;
    }
  }
}

TEST(BlueNoise, HasHardlyAnyPowerAtLowFrequencies) {
  // Below 5 cycles a square, a tenth to a half of the pixels: a pattern without clumps.
  for (const double density : {0.1, 0.25, 0.5}) {
    EXPECT_LT(low_frequency_power(density, 5, blue), 0.05) << "density " << density;
  }
}

TEST(BlueNoise, IndependentThresholdsFailTheSpectrumTest) {
  EXPECT_GT(low_frequency_power(0.25, 5, white), 0.5);
}

TEST(BlueNoise, RepeatsWithoutASeam) {
  const BlueNoise& noise = BlueNoise::get();
  EXPECT_EQ(noise.rank(3, 5), noise.rank(3 + kSide, 5 - kSide));
  // The square shifted by half its side is as blue: nothing stands at its border.
  const auto shifted = [](int x, int y) { return blue(x + kSide / 2, y + kSide / 2); };
  EXPECT_NEAR(low_frequency_power(0.25, 5, shifted), low_frequency_power(0.25, 5, blue), 1e-9);
  int touching = 0;  // pixels on both sides of the border selected at once, at density 0.1
  for (int y = 0; y < kSide; ++y) touching += blue(kSide - 1, y) < 0.1 && blue(kSide, y) < 0.1;
  EXPECT_EQ(touching, 0);
}

struct Level {
  double level;
  int most_frames;
};
class BlueNoiseRevisit : public testing::TestWithParam<Level> {};

/// The longest wait between two frames in which a pixel comes below a level.
int longest_wait(double level, int frames) {
  int longest = 0;
  for (int pixel = 0; pixel < 64; ++pixel) {
    int last = 0;
    for (int frame = 0; frame < frames; ++frame) {
      const bool selected = BlueNoise::get().threshold(pixel, 7 * pixel, frame) < level;
      longest = std::max(longest, frame - last);
      if (selected) last = frame;
    }
  }
  return longest;
}

TEST_P(BlueNoiseRevisit, APixelNeverWaitsLongerThanTheGoldenRatioAllows) {
  // Three-distance theorem: the gaps of a rotation by the golden ratio are Fibonacci numbers, the
  // longest of them 34 at level 0.05.
  EXPECT_LE(longest_wait(GetParam().level, 2000), GetParam().most_frames);
  EXPECT_GT(longest_wait(GetParam().level, 2000), GetParam().most_frames / 3);
}
INSTANTIATE_TEST_SUITE_P(Levels, BlueNoiseRevisit,
                         testing::Values(Level{0.2, 8}, Level{0.1, 13}, Level{0.05, 34},
                                         Level{0.01, 144}));

}  // namespace
}  // namespace macula::sampling
