#include "tests/bench/arguments.h"

#include <string>

#include <gtest/gtest.h>

namespace macula::bench {
namespace {

TEST(Arguments, ReadASize) {
  const auto size = parse_size("--size", "640x480");
  ASSERT_TRUE(size);
  EXPECT_EQ(size->width_px, 640);
  EXPECT_EQ(size->height_px, 480);
}

TEST(Arguments, RefuseWhatIsNoSizeAndSayWhatIs) {
  for (const char* text : {"", "640", "640x", "x480", "0x480", "-3x4", "640x480x2", "640 x 480",
                           "99999x2", "6.5x4", "99999999999999999999x1"}) {
    const auto size = parse_size("--size", text);
    ASSERT_FALSE(size) << text;
    EXPECT_EQ(size.error().exit_status(), 2);
    EXPECT_NE(size.error().message().find("640x480"), std::string::npos) << text;
  }
}

TEST(Arguments, ReadAGazeWithinTheSphere) {
  const auto gaze = parse_gaze("--gaze", "-12.5,3");
  ASSERT_TRUE(gaze);
  EXPECT_EQ(gaze->yaw.value(), -12.5);
  EXPECT_EQ(gaze->pitch.value(), 3.0);
  for (const char* text : {"1", "1,2,3", "1,nan", "inf,0", "0,91", "181,0", "a,b", "1, 2"}) {
    EXPECT_FALSE(parse_gaze("--gaze", text)) << text;
  }
}

TEST(Arguments, ARampHasTwoAnglesThatRiseAndAFloor) {
  const auto ramp = parse_ramp("--ramps", "8,30,0.05");
  ASSERT_TRUE(ramp);
  EXPECT_EQ(ramp->inner.value(), 8.0);
  EXPECT_EQ(ramp->outer.value(), 30.0);
  EXPECT_EQ(ramp->floor, 0.05);
  for (const char* text : {"", "8,30", "30,8,0.05", "-1,30,0.05", "8,181,0.05", "8,30,0", "8,30,2"})
    EXPECT_FALSE(parse_ramp("--ramps", text)) << text;
}

TEST(Arguments, ReadACameraInTheFilesOwnUnits) {
  const auto camera = parse_camera("--camera", "0,1,6.8;0,1,0;0,1,0;19.5");
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->eye, DVec3(0.0, 1.0, 6.8));
  EXPECT_EQ(camera->target, DVec3(0.0, 1.0, 0.0));
  EXPECT_EQ(camera->up, DVec3(0.0, 1.0, 0.0));
  EXPECT_EQ(camera->vertical_fov.value(), 19.5);
}

TEST(Arguments, RefuseACameraThatSeesNothing) {
  for (const char* text : {"0,0,0;0,0,0;0,1,0;60",   // looks at itself
                           "0,0,0;0,2,0;0,1,0;60",   // up along the view
                           "0,0,0;0,0,1;0,0,0;60",   // no up
                           "0,0,0;0,0,1;0,1,0;180",  // too wide
                           "0,0,0;0,0,1;0,1,0",      // no field of view
                           "0,0;0,0,1;0,1,0;60"}) {  // a number short
    EXPECT_FALSE(parse_camera("--camera", text)) << text;
  }
}

}  // namespace
}  // namespace macula::bench
