#include "tests/bench/figure_sheet.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "shared/image/draw.h"

namespace macula::bench {
namespace {

constexpr Rgb8 kGrey{90, 90, 90}, kRing{255, 255, 255};

TEST(FigureSheet, AScaleHasTheColoursOfThePlanesItStandsFor) {
  const ColorScale scale{"nodes", 0.0F, 48.0F, Ticks::Linear};
  constexpr int kWidth = 480;
  const Plane<Rgb8> bar = scale_bar(scale, kWidth);
  for (int x = 0; x < kWidth; x += 37) {
    Plane<float> value(1, 1, 48.0F * (static_cast<float>(x) + 0.5F) / kWidth);
    EXPECT_EQ(bar(x, 0), false_color(value, scale)(0, 0)) << x;
  }
}

TEST(FigureSheet, ScalesOfOtherValuesHaveTheSameColoursAndOtherWords) {
  const Plane<Rgb8> nodes = scale_bar({"nodes", 0.0F, 48.0F, Ticks::Linear}, 480);
  const Plane<Rgb8> shares = scale_bar({"shares", 0.0F, 1.0F, Ticks::Linear}, 480);
  ASSERT_EQ(nodes.rect(), shares.rect());
  EXPECT_TRUE(std::ranges::equal(nodes.row(0), shares.row(0)));
  EXPECT_FALSE(std::ranges::equal(nodes.pixels(), shares.pixels()));
}

// A disc of 12 pixels: what is drawn is its own rim, one pixel wide and closed, so that a flood
// from its middle stays inside.
TEST(FigureSheet, AnOutlineIsTheRimOfItsRegionAndClosed) {
  constexpr int kSide = 31, kMiddle = 15;
  Plane<std::uint8_t> disc(kSide, kSide);
  const auto inside = [](int x, int y) {
    return (x - kMiddle) * (x - kMiddle) + (y - kMiddle) * (y - kMiddle) <= 144;
  };
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) disc(x, y) = inside(x, y);
  Plane<Rgb8> picture(kSide, kSide, kGrey);
  outline(picture, disc, 1, kRing);
  for (int y = 1; y + 1 < kSide; ++y) {
    for (int x = 1; x + 1 < kSide; ++x) {
      const bool rim = inside(x, y) && !(inside(x - 1, y) && inside(x + 1, y) && inside(x, y - 1) &&
                                         inside(x, y + 1));
      EXPECT_EQ(picture(x, y) == kRing, rim) << x << ' ' << y;
    }
  }
  Plane<Rgb8> thick(kSide, kSide, kGrey);
  outline(thick, disc, 3, kRing);
  EXPECT_EQ(thick(kMiddle, kMiddle - 10), kRing) << "three pixels from the rim at 12";
  EXPECT_EQ(thick(kMiddle, kMiddle - 9), kGrey);
}

TEST(FigureSheet, ARegionThatIsCutOffByThePictureHasNoRimThere) {
  const Plane<std::uint8_t> all(8, 6, 1);
  Plane<Rgb8> picture(8, 6, kGrey);
  outline(picture, all, 2, kRing);
  EXPECT_EQ(std::ranges::count(picture.pixels(), kRing), 0);
}

TEST(FigureSheet, EnlargedPixelsAreSquaresCutOffAtTheSize) {
  Plane<Rgb8> small(2, 1, kGrey);
  small(1, 0) = kRing;
  const Plane<Rgb8> large = enlarged(small, 8, 13, 7);
  ASSERT_EQ(large.rect(), (image::Rect{0, 0, 13, 7}));
  for (int y = 0; y < 7; ++y)
    for (int x = 0; x < 13; ++x) EXPECT_EQ(large(x, y), x < 8 ? kGrey : kRing) << x << ' ' << y;
}

TEST(FigureSheet, PanelsKeepTheirSizeBetweenATitleAndScalesAsWideAsAll) {
  const Plane<Rgb8> picture(360, 100, kGrey);
  FigureSheet sheet{"title", 3, {}, {{"first", 0.0F, 1.0F, Ticks::Linear}}};
  for (int k = 0; k < 6; ++k) sheet.panels.push_back({picture, {"one", "two"}});
  const Plane<Rgb8> one = drawn(sheet);
  EXPECT_EQ(one.width(), 3 * 360 + 2 * 4);
  EXPECT_EQ(std::ranges::count(one.pixels(), kGrey), 6 * 360 * 100);
  sheet.scales.push_back({"second", 0.0F, 2.0F, Ticks::Linear});
  EXPECT_EQ(drawn(sheet).height() - one.height(),
            scale_bar(sheet.scales[1], one.width()).height() + 4);
}

TEST(FigureSheet, LettersGrowWithThePicturesAndNoneIsSmallerThanADot) {
  EXPECT_EQ(dot_px(32), 1);
  EXPECT_EQ(dot_px(360), 2);
  EXPECT_EQ(dot_px(720), 3);
}

}  // namespace
}  // namespace macula::bench
