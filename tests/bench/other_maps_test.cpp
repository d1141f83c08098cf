// The other systems' maps give the figures that are printed of them.
#include "tests/bench/other_maps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace macula::bench {
namespace {

// Width (s' + (1 - s') / e) W; one to one in the middle; 2 e - 1 at the border.
TEST(AlvrMap, IsSevenToOneAtTheEdgeAndOneToOneInTheMiddle) {
  constexpr int kFull = 1440;
  const auto edges = alvr_edges(kFull, {0.45, 0.0, 4.0});
  EXPECT_NEAR(edges.front(), 0.0, 1e-12);
  EXPECT_NEAR(edges.back(), 1.0, 1e-12);
  EXPECT_TRUE(std::is_sorted(edges.begin(), edges.end()));
  const auto pixels = [&](std::size_t cell) { return kFull * (edges[cell + 1] - edges[cell]); };
  EXPECT_NEAR(pixels(0), 7.0, 0.05);
  EXPECT_NEAR(pixels(edges.size() - 2), 7.0, 0.05);
  EXPECT_NEAR(pixels(edges.size() / 2), 1.0, 1e-9);
  const auto vertical = alvr_edges(1600, {0.4, 0.0, 5.0});
  EXPECT_NEAR(1600 * (vertical[1] - vertical[0]), 9.0, 0.06);
}

TEST(AlvrMap, ItsCentreMovesByWholeBlocks) {
  const auto middle_of = [](double shift) {
    const auto edges = alvr_edges(1440, {0.45, shift, 4.0});
    double sum = 0.0, count = 0.0;
    for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
      if (1440 * (edges[i + 1] - edges[i]) > 1.0 + 1e-6) continue;
      sum += 1440 * edges[i];
      count += 1.0;
    }
    return sum / count;
  };
  const double moved = middle_of(0.4) - middle_of(0.0);
  EXPECT_GT(moved, 100.0);
  EXPECT_NEAR(moved / 4.0, std::round(moved / 4.0), 1e-6);
}

// Printed: lambda .5 -> a = 1.1656, edge 6.4; gaze .6 -> edges 10.3 and 1.6; lambda .3 -> 1.3525,
// 21; gaze .6 -> 43 and 3.6.
TEST(WivrnMap, HasThePrintedConstants) {
  const WivrnCurve half = wivrn_curve({0.5, 0.0});
  EXPECT_NEAR(half.a, 1.1656, 1e-4);
  EXPECT_NEAR(half.pixel_ratio(1.0), 6.4, 0.05);
  EXPECT_NEAR(half.pixel_ratio(0.0), 1.0, 1e-9);
  const WivrnCurve aside = wivrn_curve({0.5, 0.6});
  EXPECT_NEAR(aside.pixel_ratio(-1.0), 10.3, 0.06);
  EXPECT_NEAR(aside.pixel_ratio(1.0), 1.6, 0.06);
  const WivrnCurve third = wivrn_curve({0.3, 0.0});
  EXPECT_NEAR(third.a, 1.3525, 1e-4);
  EXPECT_NEAR(third.pixel_ratio(1.0), 21.0, 0.5);
  EXPECT_NEAR(wivrn_curve({0.3, 0.6}).pixel_ratio(-1.0), 43.0, 0.5);
  EXPECT_NEAR(wivrn_curve({0.3, 0.6}).pixel_ratio(1.0), 3.6, 0.06);
}

TEST(WivrnMap, SpansAreWholePixelsThatGrowOutwardsAndFillThePicture) {
  for (const double gaze : {0.0, 0.3, -0.6}) {
    constexpr int kFull = 720;
    const auto edges = wivrn_edges(kFull, {0.5, gaze});
    EXPECT_NEAR(edges.back(), 1.0, 1e-9);
    EXPECT_NEAR(static_cast<double>(edges.size() - 1) / (0.5 * kFull), 1.0, 0.1);
    for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
      const double span = kFull * (edges[i + 1] - edges[i]);
      EXPECT_NEAR(span, std::round(span), 1e-6);
      EXPECT_GE(span, 1.0 - 1e-6);
    }
  }
}

}  // namespace
}  // namespace macula::bench
