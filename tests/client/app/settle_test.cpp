#include "client/app/settle.h"

#include <gtest/gtest.h>

namespace macula::client_app {
namespace {

TEST(Settling, BeginsWhenFramesAreLateAndEnds) {
  EXPECT_EQ(settled_share(units::from_ms(0.0)), 0.0);
  EXPECT_EQ(settled_share(kSettleAfter), 0.0);
  EXPECT_NEAR(settled_share(kSettleAfter + kSettleTime / 2), 0.5, 1e-9);
  EXPECT_EQ(settled_share(units::from_s(60.0)), 1.0);
}

TEST(Settling, RisesWithoutASteepStep) {
  double before = 0.0;
  for (int ms = 0; ms <= 2000; ms += 11) {  // refreshes of 90 Hz
    const double share = settled_share(units::from_ms(ms));
    EXPECT_GE(share, before);
    EXPECT_LT(share - before, 0.03);
    before = share;
  }
}

TEST(Settling, TakesTheEyeBackAndLeavesItsTurn) {
  const Pose display{{1.0, 1.6, -2.0}, glm::angleAxis(0.3, DVec3{0, 1, 0})};
  const Pose frame{{0.0, 1.6, 0.0}, DQuat{1, 0, 0, 0}};
  EXPECT_EQ(settled_pose(display, frame, 0.0).position, display.position);
  EXPECT_EQ(settled_pose(display, frame, 1.0).position, frame.position);
  EXPECT_NEAR(settled_pose(display, frame, 0.25).position.x, 0.75, 1e-12);
  EXPECT_EQ(settled_pose(display, frame, 1.0).rotation, display.rotation);
}

TEST(Settling, DarkensTheRimAndNotTheMiddle) {
  image::Plane<Rgb8> picture(101, 81, Rgb8{200, 100, 50});
  draw_vignette(picture, 0.0);
  EXPECT_EQ(picture(0, 0), (Rgb8{200, 100, 50}));
  draw_vignette(picture, 1.0);
  EXPECT_EQ(picture(50, 40), (Rgb8{200, 100, 50}));
  EXPECT_NEAR(picture(0, 0).r, 100, 4);
  EXPECT_NEAR(picture(0, 40).r, 150, 3);
  for (int x = 51; x < 101; ++x) EXPECT_LE(picture(x, 40).r, picture(x - 1, 40).r);
}

}  // namespace
}  // namespace macula::client_app
