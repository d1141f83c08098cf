#include "tests/bench/still_planes.h"

#include <limits>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "shared/image/draw.h"

namespace macula::bench {
namespace {

using image::Plane;

constexpr int kWidth = 200, kHeight = 10;

/// 0 to 199 along x, and a sky where nothing was hit.
StillLayer ramp(StillPlane kind) {
  Plane<float> plane(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) plane(x, y) = static_cast<float>(x);
  }
  plane(150, 0) = std::numeric_limits<float>::infinity();
  StillLayer layer{kind, "ramp", {}};
  layer.channels.emplace_back("ramp.Y", std::move(plane));
  return layer;
}

TEST(StillPlanes, ScalarsStandOverABarOfTheSameColours) {
  const Plane<Rgb8> picture = picture_of(ramp(StillPlane::Depth));
  ASSERT_EQ(picture.width(), kWidth);
  ASSERT_GT(picture.height(), kHeight);
  // The ramp runs from 0 to 199 as the bar runs from left to right, so both agree but for the 1 %
  // that the percentiles cut off at each end: 255 / 200 colours a step.
  for (int x = 10; x < kWidth - 10; x += 20) {
    EXPECT_NEAR(picture(x, 1).g, picture(x, kHeight).g, 4) << x;
  }
  EXPECT_EQ(picture(150, 0), image::false_color(1.0F)) << "infinity is the far end";
}

TEST(StillPlanes, EveryIdHasItsColourAndNothingIsBlack) {
  const Plane<Rgb8> picture = picture_of(ramp(StillPlane::Id));
  EXPECT_EQ(picture.height(), kHeight) << "no bar where values mean nothing";
  EXPECT_EQ(picture(0, 0), Rgb8{});
  std::set<std::tuple<int, int, int>> colors;
  for (int x = 1; x < kWidth; ++x) {
    colors.emplace(picture(x, 1).r, picture(x, 1).g, picture(x, 1).b);
  }
  EXPECT_EQ(colors.size(), kWidth - 1U);
}

TEST(StillPlanes, AConstantPlaneIsDrawnToo) {
  StillLayer layer{StillPlane::Samples, "samples", {}};
  layer.channels.emplace_back("samples.Y", Plane<float>(50, 5, 16.0F));
  EXPECT_EQ(picture_of(layer)(3, 3), image::false_color(0.5F));
}

}  // namespace
}  // namespace macula::bench
