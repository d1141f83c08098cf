#include "server/kernels/sphere/keep.h"

#include <gtest/gtest.h>

namespace macula::kernels::sphere {
namespace {

TEST(Keep, EveryCellIsDueOnceAPeriod) {
  for (const Refresh refresh : {Refresh::EveryFrame, Refresh::EverySecond, Refresh::EveryFourth}) {
    for (int y = 0; y < 4; ++y) {
      for (int x = 0; x < 4; ++x) {
        int due = 0;
        for (int frame = 0; frame < period(refresh); ++frame)
          due += is_due(x, y, 100 + static_cast<std::uint64_t>(frame), refresh);
        EXPECT_EQ(due, 1) << x << ", " << y << " of period " << period(refresh);
      }
    }
  }
}

TEST(Keep, AnEvenShareOfTheCellsIsDueInEveryFrame) {
  for (std::uint64_t frame = 0; frame < 4; ++frame) {
    int due = 0;
    for (int y = 0; y < 8; ++y)
      for (int x = 0; x < 8; ++x) due += is_due(x, y, frame, Refresh::EveryFourth);
    EXPECT_EQ(due, 16);
  }
}

}  // namespace
}  // namespace macula::kernels::sphere
