#include "client/pose/interactive_source.h"

#include <gtest/gtest.h>

namespace macula::pose {
namespace {

constexpr ClientTime kNow{units::from_s(3.0)};

TEST(InteractiveSource, LooksWhereTheCursorIs) {
  InteractiveSource source;
  Steering steering;
  steering.gaze_tangent = DVec2{1.0, 0.0};  // 45 degrees to the right
  source.steer(steering);
  const HeadSample sample = *source.sample(kNow);
  EXPECT_TRUE(sample.gaze.valid);
  EXPECT_NEAR(sample.gaze.direction.x, std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(sample.gaze.direction.z, -std::sqrt(0.5), 1e-6);
  EXPECT_EQ(sample.at, kNow);
}

TEST(InteractiveSource, KeepsTheLastGazeAsInvalidWhenTheCursorLeaves) {
  InteractiveSource source;
  Steering steering;
  steering.gaze_tangent = DVec2{0.5, 0.0};
  source.steer(steering);
  const Vec3 last = source.sample(kNow)->gaze.direction;
  source.steer({});
  EXPECT_FALSE(source.sample(kNow)->gaze.valid);
  EXPECT_EQ(source.sample(kNow)->gaze.direction, last);
}

// After a quarter turn to the left the head looks along -X, and "forwards" leads there.
TEST(InteractiveSource, MovesAlongItsHeading) {
  InteractiveSource source;
  Steering steering;
  steering.turn_left = Degrees{90.0};
  steering.move_m = {0.0, 0.0, -2.0};
  source.steer(steering);
  const Pose head = source.sample(kNow)->stage_from_head;
  EXPECT_NEAR(head.position.x, -2.0, 1e-12);
  EXPECT_NEAR(head.position.z, 0.0, 1e-12);
  EXPECT_NEAR(head.transform_direction(DVec3(0.0, 0.0, -1.0)).x, -1.0, 1e-12);
}

TEST(InteractiveSource, NeverTurnsOverAndComesBackOnReset) {
  InteractiveSource source;
  Steering up;
  up.turn_up = Degrees{400.0};
  source.steer(up);
  const DVec3 sees =
      source.sample(kNow)->stage_from_head.transform_direction(DVec3(0.0, 0.0, -1.0));
  EXPECT_NEAR(sees.y, std::sin(Radians{Degrees{85.0}}.value()), 1e-12);
  Steering reset;
  reset.reset = Steering::Reset::Yes;
  source.steer(reset);
  EXPECT_EQ(source.sample(kNow)->stage_from_head.position, DVec3(0.0, 1.6, 0.0));
  EXPECT_NEAR(source.sample(kNow)->stage_from_head.rotation.w, 1.0, 1e-12);
}

}  // namespace
}  // namespace macula::pose
