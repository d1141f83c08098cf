#include "client/app/eye_rig.h"

#include <gtest/gtest.h>

#include "shared/math/frames.h"

namespace macula::client_app {
namespace {

EyeRig rig() {
  return {{math::symmetric_fov(Degrees{80.0}, 1.0), 64, 64}};
}

TEST(EyeRig, PutsTheEyesHalfTheirDistanceLeftAndRight) {
  EXPECT_DOUBLE_EQ(rig().head_from_eye(0).position.x, -0.0315);
  EXPECT_DOUBLE_EQ(rig().head_from_eye(1).position.x, 0.0315);
  EyeRig one = rig();
  one.eyes = 1;
  EXPECT_EQ(one.head_from_eye(0).position, DVec3(0.0));
}

// Straight ahead at 1 m, an eye 31.5 mm aside turns inwards by atan(0.0315).
TEST(EyeRig, TurnsBothEyesToThePointTheHeadLooksAt) {
  const Gaze ahead;
  const Vec3 left = rig().gaze_of(0, ahead).direction, right = rig().gaze_of(1, ahead).direction;
  EXPECT_NEAR(left.x / -left.z, 0.0315, 1e-6);
  EXPECT_NEAR(right.x / -right.z, -0.0315, 1e-6);
}

TEST(EyeRig, MakesTheLinesOfSightMeetForAnyGaze) {
  Gaze gaze;
  gaze.direction = glm::normalize(Vec3{0.4F, -0.3F, -1.0F});
  const DVec3 target(gaze.direction);
  for (const int eye : {0, 1}) {
    const DVec3 from = rig().head_from_eye(eye).position;
    const DVec3 sight(rig().gaze_of(eye, gaze).direction);
    EXPECT_LT(glm::length(glm::cross(sight, target - from)), 1e-6);
  }
}

TEST(EyeRig, FindsTheHeadsGazeBackFromOneEyes) {
  Gaze gaze;
  gaze.direction = glm::normalize(Vec3{-0.35F, 0.2F, -1.0F});
  for (const int eye : {0, 1}) {
    const DVec2 tangent(math::tangent_from_direction(rig().gaze_of(eye, gaze).direction));
    EXPECT_LT(glm::length(rig().head_gaze_through(eye, tangent) - gaze.direction), 1e-5F);
  }
}

TEST(EyeRig, PassesOnWhetherTheGazeIsKnown) {
  Gaze lost;
  lost.valid = false;
  lost.confidence = 0.25F;
  const net::ViewState view = rig().view_state(Pose{}, lost);
  ASSERT_EQ(view.eyes.size(), 2U);
  EXPECT_FALSE(view.eyes[1].gaze.valid);
  EXPECT_EQ(view.eyes[1].gaze.confidence, 0.25F);
  EXPECT_EQ(view.eyes[0].fov.up, rig().display.fov.up);
}

}  // namespace
}  // namespace macula::client_app
