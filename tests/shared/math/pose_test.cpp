#include "shared/math/pose.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

namespace macula::math {
namespace {

Pose turned(double yaw_rad, const DVec3& position) {
  return {position, glm::angleAxis(yaw_rad, DVec3(0.0, 1.0, 0.0))};
}

void expect_near(const DVec3& a, const DVec3& b, double tolerance) {
  EXPECT_LT(glm::length(a - b), tolerance) << a.x << ' ' << a.y << ' ' << a.z;
}

TEST(Pose, CompositionReadsTargetFromSource) {
  const Pose a_from_b = turned(0.5, {1.0, 2.0, 3.0}), b_from_c = turned(-1.2, {0.0, -1.0, 4.0});
  const DVec3 point_c{0.3, 0.7, -0.2};
  expect_near((a_from_b * b_from_c).transform_point(point_c),
              a_from_b.transform_point(b_from_c.transform_point(point_c)), 1e-14);
}

TEST(Pose, InverseUndoesTheTransform) {
  const Pose pose = turned(2.0, {100.0, -5.0, 0.25});
  const DVec3 point{3.0, 4.0, 5.0};
  expect_near(inverse(pose).transform_point(pose.transform_point(point)), point, 1e-12);
}

TEST(Pose, PositiveYawTurnsTheViewToTheLeft) {
  // Right-handed about +Y: -Z (ahead) goes towards -X (left).
  expect_near(turned(std::numbers::pi / 2, DVec3(0.0)).transform_direction({0.0, 0.0, -1.0}),
              {-1.0, 0.0, 0.0}, 1e-15);
}

TEST(Pose, LookAtPutsTheTargetStraightAheadAndUpUpwards) {
  const DVec3 eye{1.0, 2.0, 3.0}, target{-4.0, 0.0, 7.0};
  const Pose world_from_view = look_at(eye, target, {0.0, 1.0, 0.0});
  const DVec3 seen = inverse(world_from_view).transform_point(target);
  expect_near(seen, {0.0, 0.0, -glm::length(target - eye)}, 1e-12);
  EXPECT_GT(world_from_view.transform_direction({0.0, 1.0, 0.0}).y, 0.0);
}

TEST(Pose, AngleBetweenIsExactForTinyAndForHalfTurns) {
  EXPECT_NEAR(angle_between(turned(0.0, {}), turned(1e-9, {})).value(), 1e-9, 1e-15);
  EXPECT_NEAR(angle_between(turned(0.0, {}), turned(std::numbers::pi, {})).value(),
              std::numbers::pi, 1e-12);
}

TEST(Pose, InterpolationHitsBothEndsAndTakesTheShorterArc) {
  const Pose a = turned(0.1, {0.0, 0.0, 0.0});
  Pose b = turned(0.5, {2.0, 0.0, 0.0});
  b.rotation = -b.rotation;  // the same rotation, written with the other sign
  EXPECT_NEAR(angle_between(interpolate(a, b, 0.5), turned(0.3, {})).value(), 0.0, 1e-12);
  expect_near(interpolate(a, b, 1.0).position, b.position, 1e-15);
}

TEST(Pose, IsValidRefusesWhatCannotBeRendered) {
  EXPECT_TRUE(is_valid(turned(1.0, {1.0, 2.0, 3.0})));
  Pose pose;
  pose.position.x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(is_valid(pose));
  pose = Pose{{1e30, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}};
  EXPECT_FALSE(is_valid(pose));
  pose = Pose{{0.0, 0.0, 0.0}, {0.9, 0.0, 0.0, 0.0}};
  EXPECT_FALSE(is_valid(pose)) << "not a unit quaternion";
}

}  // namespace
}  // namespace macula::math
