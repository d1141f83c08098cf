#include "client/app/eye_rig.h"

#include <gtest/gtest.h>

#include "shared/math/frames.h"

namespace macula::client_app {
namespace {

EyeRig rig() {
  return EyeRig::side_by_side({math::symmetric_fov(Degrees{80.0}, 1.0), 64, 64}, 2, Meters{0.063},
                              Meters{1.0});
}

TEST(EyeRig, PutsTheEyesHalfTheirDistanceLeftAndRight) {
  EXPECT_DOUBLE_EQ(rig().eyes[0].head_from_eye.position.x, -0.0315);
  EXPECT_DOUBLE_EQ(rig().eyes[1].head_from_eye.position.x, 0.0315);
  const EyeRig one = EyeRig::side_by_side(rig().eyes[0].display, 1, Meters{0.063}, Meters{1.0});
  EXPECT_EQ(one.eyes[0].head_from_eye.position, DVec3(0.0));
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
  for (const std::size_t eye : {0U, 1U}) {
    const DVec3 from = rig().eyes[eye].head_from_eye.position;
    const DVec3 sight(rig().gaze_of(eye, gaze).direction);
    EXPECT_LT(glm::length(glm::cross(sight, target - from)), 1e-6);
  }
}

TEST(EyeRig, FindsTheHeadsGazeBackFromOneEyes) {
  Gaze gaze;
  gaze.direction = glm::normalize(Vec3{-0.35F, 0.2F, -1.0F});
  for (const std::size_t eye : {0U, 1U}) {
    const DVec2 tangent(math::tangent_from_direction(rig().gaze_of(eye, gaze).direction));
    EXPECT_LT(glm::length(rig().head_gaze_through(eye, tangent) - gaze.direction), 1e-5F);
  }
}

// A headset's eyes may be canted and see more outwards than inwards.
TEST(EyeRig, SpeaksOfEachEyeAsItStands) {
  EyeRig canted = rig();
  canted.eyes[1].head_from_eye.rotation = glm::angleAxis(-0.1, DVec3{0.0, 1.0, 0.0});  // outwards
  canted.eyes[1].display.fov.right = Radians{0.9};
  canted.convergence = Meters{1e6};
  const Vec3 direction = canted.gaze_of(1, Gaze{}).direction;
  EXPECT_NEAR(direction.x, -std::sin(0.1), 1e-6);
  const DVec2 tangent(math::tangent_from_direction(direction));
  EXPECT_NEAR(canted.head_gaze_through(1, tangent).x, 0.0, 1e-6);
  const net::ViewState view = canted.view_state(Pose{}, Gaze{});
  EXPECT_EQ(view.eyes[1].fov.right, Radians{0.9});
  EXPECT_NE(view.eyes[0].fov.right, Radians{0.9});
}

TEST(EyeRig, PassesOnWhetherTheGazeIsKnown) {
  Gaze lost;
  lost.valid = false;
  lost.confidence = 0.25F;
  const net::ViewState view = rig().view_state(Pose{}, lost);
  ASSERT_EQ(view.eyes.size(), 2U);
  EXPECT_FALSE(view.eyes[1].gaze.valid);
  EXPECT_EQ(view.eyes[1].gaze.confidence, 0.25F);
  EXPECT_EQ(view.eyes[0].fov.up, rig().eyes[0].display.fov.up);
}

}  // namespace
}  // namespace macula::client_app
