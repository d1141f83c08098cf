#include "client/display/window/layout.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace macula::display {
namespace {

using image::Rect;

TEST(WindowLayout, PicturesThatFitExactlyMapPixelToPixel) {
  const std::array pictures{PictureSize{160, 120}, PictureSize{160, 120}};
  const auto places = place_side_by_side(pictures, {320, 120});
  ASSERT_EQ(places.size(), 2U);
  EXPECT_EQ(places[0], (Rect{0, 0, 160, 120}));
  EXPECT_EQ(places[1], (Rect{160, 0, 160, 120}));
}

TEST(WindowLayout, SpareRoomIsSplitEvenly) {
  const std::array square{PictureSize{100, 100}};
  EXPECT_EQ(place_side_by_side(square, {320, 120})[0], (Rect{100, 0, 120, 120}));
  EXPECT_EQ(place_side_by_side(square, {50, 120})[0], (Rect{0, 35, 50, 50}));
}

TEST(WindowLayout, NothingOverlapsOrLeavesTheWindowAndAspectIsKept) {
  const std::array pictures{PictureSize{1440, 1600}, PictureSize{1440, 1600}};
  for (int width = 1; width < 900; width += 7)
    for (int height = 1; height < 700; height += 11) {
      const auto places = place_side_by_side(pictures, {width, height});
      EXPECT_EQ(places[0].x + places[0].width, places[1].x);
      for (const auto& place : places) {
        EXPECT_GE(place.x, 0);
        EXPECT_GE(place.y, 0);
        EXPECT_LE(place.x + place.width, width);
        EXPECT_LE(place.y + place.height, height);
        EXPECT_NEAR(place.width * 1600.0 / 1440.0, place.height, 2.0);
      }
      // One side is used in full.
      const bool full = places[1].x + places[1].width - places[0].x >= width - 1 ||
                        places[0].height >= height - 1;
      EXPECT_TRUE(full) << width << " x " << height;
    }
}

TEST(WindowLayout, WithoutPixelsThereIsNoPlace) {
  EXPECT_TRUE(place_side_by_side({}, {100, 100}).empty());
  const std::array none{PictureSize{0, 0}};
  EXPECT_EQ(place_side_by_side(none, {100, 100})[0], Rect{});
  const std::array some{PictureSize{10, 10}};
  EXPECT_EQ(place_side_by_side(some, {0, 0})[0].width, 0);
}

TEST(WindowLayout, APositionFindsItsPictureAndPlaceInIt) {
  const std::array places{Rect{10, 20, 100, 50}, Rect{110, 20, 100, 50}};
  const auto left = picture_at(places, 10.0F, 20.0F);
  ASSERT_TRUE(left);
  EXPECT_EQ(left->picture, 0);
  EXPECT_EQ(left->at.u, 0.0F);
  EXPECT_EQ(left->at.v, 0.0F);
  const auto right = picture_at(places, 160.0F, 45.0F);
  ASSERT_TRUE(right);
  EXPECT_EQ(right->picture, 1);
  EXPECT_FLOAT_EQ(right->at.u, 0.5F);
  EXPECT_FLOAT_EQ(right->at.v, 0.5F);
  EXPECT_FALSE(picture_at(places, 9.0F, 30.0F));
  EXPECT_FALSE(picture_at(places, 50.0F, 70.0F));
  EXPECT_FALSE(picture_at(places, std::nanf(""), 30.0F));
}

}  // namespace
}  // namespace macula::display
