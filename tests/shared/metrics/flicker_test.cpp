#include "shared/metrics/flicker.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/shared/metrics/formula_images.h"

namespace macula::metrics {
namespace {

using test::picture;
using test::rnd;

constexpr int kFrames = 8;

Plane<float> grey(float value) {
  return picture([value](int, int) { return value; });
}

// Alternating +a and -a around any mean has a temporal RMS of a.
TEST(Flicker, OfAnAlternatingPictureIsItsAmplitude) {
  FlickerMeter meter;
  for (int i = 0; i < kFrames; ++i) meter.add(grey(0.4F), grey(i % 2 == 0 ? 0.55F : 0.45F));
  EXPECT_NEAR(meter.rms(), 0.05, 1e-6);
}

TEST(Flicker, OfAConstantErrorIsZero) {
  FlickerMeter meter;
  for (int i = 0; i < kFrames; ++i) meter.add(grey(0.4F), grey(0.9F));
  EXPECT_EQ(meter.rms(), 0.0);
  for (const double band : meter.rms_per_band()) EXPECT_EQ(band, 0.0);
}

TEST(Flicker, FollowsAReferenceThatChanges) {
  FlickerMeter meter;
  for (int i = 0; i < kFrames; ++i) {
    const float level = 0.1F * static_cast<float>(i);
    meter.add(grey(level), grey(level + 0.1F));
  }
  EXPECT_NEAR(meter.rms(), 0.0, 1e-7);
}

TEST(Flicker, OfIndependentNoiseIsTheNoise) {
  // Uniform in +-.05: deviation .1 / sqrt(12); n frames show sqrt((n - 1) / n) of it on average.
  FlickerMeter meter;
  for (int i = 0; i < kFrames; ++i) {
    meter.add(grey(0.5F), picture([i](int x, int y) {
                return 0.45F + 0.1F * rnd(static_cast<std::uint32_t>((i * 48 + y) * 64 + x));
              }));
  }
  EXPECT_NEAR(meter.rms(), 0.1 / std::sqrt(12.0) * std::sqrt(7.0 / 8.0), 5e-4);
}

TEST(Flicker, LandsInTheBandOfItsSpatialFrequency) {
  FlickerMeter fine, coarse;
  for (int i = 0; i < kFrames; ++i) {
    const float sign = i % 2 == 0 ? 0.05F : -0.05F;
    fine.add(grey(0.5F),
             picture([&](int x, int y) { return 0.5F + ((x + y) % 2 == 0 ? sign : -sign); }));
    coarse.add(grey(0.5F), grey(0.5F + sign));
  }
  const auto fine_bands = fine.rms_per_band(), coarse_bands = coarse.rms_per_band();
  EXPECT_EQ(std::ranges::max_element(fine_bands) - fine_bands.begin(), 0);
  EXPECT_EQ(std::ranges::max_element(coarse_bands) - coarse_bands.begin(), 5);
  EXPECT_NEAR(coarse_bands.back(), 0.05, 1e-6);
}

TEST(WarpedFlicker, CountsOnlyChangeThatTheReferenceLacks) {
  const auto a = grey(0.2F), b = grey(0.5F), c = grey(0.6F);
  const Plane<unsigned char> all(64, 48, 1);
  EXPECT_NEAR(warped_flicker_rms({b, a, b, a}, all), 0.0, 1e-7) << "both rose by .3";
  EXPECT_NEAR(warped_flicker_rms({c, a, b, a}, all), 0.1, 1e-6) << "the test rose by .1 more";
}

TEST(WarpedFlicker, LeavesDisocclusionsOut) {
  auto broken = grey(0.2F);
  Plane<unsigned char> visible(64, 48, 1);
  for (int x = 0; x < 64; ++x) {
    broken(x, 0) = 1.0F;
    visible(x, 0) = 0;
  }
  const auto steady = grey(0.2F);
  EXPECT_EQ(warped_flicker_rms({broken, steady, steady, steady}, visible), 0.0);
  EXPECT_EQ(warped_flicker_rms({broken, steady, steady, steady}, Plane<unsigned char>(64, 48, 0)),
            0.0);
}

}  // namespace
}  // namespace macula::metrics
