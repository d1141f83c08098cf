#include "client/display/window/comparison.h"

#include <gtest/gtest.h>

namespace macula::display {
namespace {

using image::Plane;

constexpr Rgb8 kFirst{10, 20, 30}, kSecond{10, 25, 200}, kLine{255, 255, 255};

TEST(Comparison, AWipeLeavesEachPictureItsSide) {
  const Plane<Rgb8> first(10, 2, kFirst), second(10, 2, kSecond);
  const auto picture = wiped(first, second, 0.6F);
  for (int x = 0; x < 10; ++x) {
    const Rgb8 expected = x < 5 ? kFirst : x < 7 ? kLine : kSecond;
    EXPECT_EQ(picture(x, 0), expected) << x;
    EXPECT_EQ(picture(x, 1), expected) << x;
  }
}

TEST(Comparison, AWipeMayStandAtEitherEdge) {
  const Plane<Rgb8> first(4, 1, kFirst), second(4, 1, kSecond);
  EXPECT_EQ(wiped(first, second, 0.0F)(1, 0), kSecond);
  EXPECT_EQ(wiped(first, second, 0.0F)(0, 0), kLine);
  EXPECT_EQ(wiped(first, second, 1.0F)(2, 0), kFirst);
  EXPECT_EQ(wiped(first, second, 1.0F)(3, 0), kLine);
}

TEST(Comparison, ADifferenceIsFourTimesAsBrightAndTheSameEitherWay) {
  const Plane<Rgb8> first(3, 1, kFirst), second(3, 1, kSecond);
  EXPECT_EQ(difference_map(first, second)(1, 0), (Rgb8{0, 20, 255}));
  EXPECT_EQ(difference_map(second, first)(1, 0), (Rgb8{0, 20, 255}));
  EXPECT_EQ(difference_map(first, first)(1, 0), (Rgb8{}));
}

TEST(Comparison, ViewsComeRound) {
  ComparisonView view = ComparisonView::Off;
  for (int i = 0; i < 4; ++i) {
    view = next(view);
    EXPECT_EQ(view == ComparisonView::Off, i == 3);
  }
}

}  // namespace
}  // namespace macula::display
