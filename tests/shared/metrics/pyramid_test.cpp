#include "shared/metrics/pyramid.h"

#include <gtest/gtest.h>

#include "shared/metrics/convolution.h"
#include "tests/shared/metrics/formula_images.h"

namespace macula::metrics {
namespace {

Plane<float> noise(int width, int height) {
  return test::picture(width, height, [width](int x, int y) {
    return test::rnd(static_cast<std::uint32_t>(y * width + x));
  });
}

TEST(LaplacianPyramid, AddsUpToThePicture) {
  const auto in = noise(37, 22);  // odd sizes on the way down
  const auto bands = laplacian_pyramid(in, 4);
  ASSERT_EQ(bands.size(), 5U);
  Plane<float> sum = bands.back();
  for (std::size_t b = 4; b-- > 0;) {
    sum = expand(sum, bands[b].width(), bands[b].height());
    for (std::size_t i = 0; i < sum.size(); ++i) sum.data()[i] += bands[b].data()[i];
  }
  for (std::size_t i = 0; i < in.size(); ++i) EXPECT_NEAR(sum.data()[i], in.data()[i], 1e-6F);
}

TEST(LaplacianPyramid, LeavesAConstantToTheLastBand) {
  const auto bands = laplacian_pyramid(Plane<float>(40, 24, 0.7F), 3);
  for (std::size_t b = 0; b < 3; ++b) {
    for (const float value : bands[b].pixels()) EXPECT_NEAR(value, 0.0F, 1e-6F);
  }
  for (const float value : bands[3].pixels()) EXPECT_NEAR(value, 0.7F, 1e-6F);
}

TEST(LaplacianPyramid, AcceptsASinglePixel) {
  const auto bands = laplacian_pyramid(Plane<float>(1, 1, 0.25F), 5);
  EXPECT_NEAR(bands.back()(0, 0), 0.25F, 1e-6F);
}

TEST(SeparableFilter, SpreadsAnImpulseAsTheProductOfItsTaps) {
  Plane<float> impulse(9, 7, 0.0F);
  impulse(4, 3) = 1.0F;
  const Taps<float> across = {1.0F, 2.0F, 4.0F}, down = {3.0F, 5.0F, 7.0F};
  const auto out = filter_separable(impulse, across, down);
  for (int j = -1; j <= 1; ++j) {
    for (int k = -1; k <= 1; ++k) {
      // A correlation: the pixel right of the impulse sees it through the left tap.
      EXPECT_EQ(out(4 + k, 3 + j),
                across[static_cast<std::size_t>(1 - k)] * down[static_cast<std::size_t>(1 - j)]);
    }
  }
}

TEST(SeparableFilter, RepeatsTheEdgePixel) {
  const auto taps = gaussian_taps<double>(2.0, 6);
  const auto out = filter_separable(Plane<double>(3, 2, 5.0), taps, taps);
  for (const double value : out.pixels()) EXPECT_NEAR(value, 5.0, 1e-12);
}

}  // namespace
}  // namespace macula::metrics
