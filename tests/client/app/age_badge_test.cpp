#include "client/app/age_badge.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace macula::client_app {
namespace {

TEST(AgeBadge, SaysHowOldAFrozenPictureIsAndNothingElse) {
  EXPECT_EQ(age_badge(units::from_ms(300.0)), "");
  EXPECT_EQ(age_badge(units::from_s(1.25)), "1.2 s old");
  EXPECT_EQ(age_badge(units::from_s(42.0)), "42 s old");
}

TEST(AgeBadge, IsDrawnOnOldPicturesOnlyAndLeavesTheMiddleFree) {
  image::Plane<Rgb8> picture(640, 640, Rgb8{90, 90, 90});
  const auto fresh = picture;
  draw_age_badge(picture, units::from_ms(100.0));
  EXPECT_TRUE(std::equal(picture.pixels().begin(), picture.pixels().end(), fresh.pixels().begin()));
  draw_age_badge(picture, units::from_s(2.0));
  const auto amber =
      std::count(picture.pixels().begin(), picture.pixels().end(), Rgb8{255, 176, 32});
  EXPECT_GT(amber, 100);
  for (int y = 280; y < 360; ++y) {
    for (int x = 0; x < 640; ++x) ASSERT_EQ(picture(x, y), fresh(x, y));
  }
}

TEST(AgeBadge, FitsPicturesOfAnySize) {
  for (const int side : {1, 5, 16, 3000}) {
    image::Plane<Rgb8> picture(side, side, Rgb8{90, 90, 90});
    draw_age_badge(picture, units::from_s(3.0));
  }
}

}  // namespace
}  // namespace macula::client_app
