#include "shared/image/draw.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "shared/image/tone.h"

namespace macula::image {
namespace {

float shown_luminance(Rgb8 color) {
  Plane<Rgb8> pixel(1, 1, color);
  return luminance(decode_display_linear(pixel)(0, 0));
}

TEST(FalseColor, GrowsBrighterWithEveryStep) {
  constexpr int kSteps = 64;
  for (int i = 1; i <= kSteps; ++i)
    EXPECT_GT(shown_luminance(false_color(static_cast<float>(i) / kSteps)),
              shown_luminance(false_color(static_cast<float>(i - 1) / kSteps)))
        << i;
}

TEST(FalseColor, RunsFromDarkBlueToYellowAndClampsOutside) {
  const Rgb8 first = false_color(0.0F), last = false_color(1.0F);
  EXPECT_GT(first.b, first.r);
  EXPECT_GT(first.b, first.g);
  EXPECT_GT(last.r, 200);
  EXPECT_GT(last.g, 200);
  EXPECT_LT(last.b, 140);
  EXPECT_EQ(false_color(-std::numeric_limits<float>::infinity()), first);
  EXPECT_EQ(false_color(std::numeric_limits<float>::infinity()), last);
}

TEST(FalseColor, ShowsNanAsMagentaAndScalesPlanes) {
  Plane<float> values(3, 1);
  values(0, 0) = 2.0F;
  values(1, 0) = std::nanf("");
  values(2, 0) = 6.0F;
  const auto shown = false_color(values, 2.0F, 6.0F);
  EXPECT_EQ(shown(0, 0), false_color(0.0F));
  EXPECT_EQ(shown(1, 0), (Rgb8{255, 0, 255}));
  EXPECT_EQ(shown(2, 0), false_color(1.0F));
}

TEST(Downscale, AveragesLightNotCodes) {
  // Half black, half white is 0.5 in linear light, which sRGB writes as 188.
  Plane<Rgb8> stripes(8, 4);
  for (int y = 0; y < 4; ++y)
    for (int x = 1; x < 8; x += 2) stripes(x, y) = {255, 255, 255};
  const auto shrunk = downscale(stripes, 4);
  ASSERT_EQ(shrunk.width(), 4);
  ASSERT_EQ(shrunk.height(), 2);
  for (const Rgb8 pixel : shrunk.pixels()) EXPECT_EQ(pixel, (Rgb8{188, 188, 188}));
}

TEST(Downscale, KeepsAConstantPictureAtAnyRatio) {
  const Plane<Rgb8> flat(37, 23, Rgb8{10, 128, 250});
  for (int width = 1; width < 37; ++width) {
    const auto shrunk = downscale(flat, width);
    EXPECT_EQ(shrunk.width(), width);
    EXPECT_EQ(shrunk.height(), std::max(1L, std::lround(23.0 * width / 37.0)));
    for (const Rgb8 pixel : shrunk.pixels()) EXPECT_EQ(pixel, (Rgb8{10, 128, 250}));
  }
}

TEST(Downscale, LeavesSmallPicturesAlone) {
  const Plane<Rgb8> small(5, 3, Rgb8{1, 2, 3});
  EXPECT_EQ(downscale(small, 5).width(), 5);
  EXPECT_EQ(downscale(small, 50).width(), 5);
}

TEST(ContactSheet, PlacesTilesInRowsFourPixelsApart) {
  std::vector<Plane<Rgb8>> pictures;
  for (int i = 0; i < 5; ++i)
    pictures.emplace_back(20, 10, Rgb8{static_cast<std::uint8_t>(50 * i + 5), 0, 0});
  const auto sheet = contact_sheet(pictures, 2, 10);  // tiles of 10 x 5 in three rows
  ASSERT_EQ(sheet.width(), 2 * 10 + 4);
  ASSERT_EQ(sheet.height(), 3 * 5 + 2 * 4);
  for (int i = 0; i < 5; ++i) {
    const int left = (i % 2) * 14, top = (i / 2) * 9;
    EXPECT_EQ(sheet(left, top).r, 50 * i + 5);
    EXPECT_EQ(sheet(left + 9, top + 4).r, 50 * i + 5);
  }
  EXPECT_EQ(sheet(10, 0), Rgb8{});  // the gaps are black
  EXPECT_EQ(sheet(0, 5), Rgb8{});
  EXPECT_EQ(sheet(14, 18), Rgb8{});  // and so is the missing sixth
}

TEST(ContactSheet, IsNoWiderThanItsPicturesAndEmptyWithoutAny) {
  EXPECT_EQ(contact_sheet({Plane<Rgb8>(8, 8)}, 6, 8).width(), 8);
  EXPECT_TRUE(contact_sheet({}, 3, 8).empty());
}

TEST(DrawCross, IsClippedAtTheBorder) {
  Plane<Rgb8> picture(4, 4);
  const Rgb8 red{255, 0, 0};
  draw_cross(picture, {0, 3}, 2, red);
  for (const Pixel p : {Pixel{0, 3}, Pixel{1, 3}, Pixel{2, 3}, Pixel{0, 2}, Pixel{0, 1}})
    EXPECT_EQ(picture(p.x, p.y), red);
  EXPECT_EQ(picture(3, 3), Rgb8{});
  EXPECT_EQ(picture(1, 2), Rgb8{});
  draw_cross(picture, {-10, -10}, 3, red);
}

}  // namespace
}  // namespace macula::image
