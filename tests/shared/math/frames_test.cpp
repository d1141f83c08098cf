// Pins the conventions that shared/math/frames.h states once for the whole project.
#include "shared/math/frames.h"

#include <gtest/gtest.h>

#include <limits>

#include "shared/math/fov.h"
#include "shared/math/pose.h"

namespace macula::math {
namespace {

TEST(Frames, AViewLooksDownMinusZWithXRightAndYUp) {
  const Pose world_from_view;  // at the origin, unrotated
  const DVec3 ahead = world_from_view.transform_direction({0.0, 0.0, -1.0});
  EXPECT_EQ(ahead, DVec3(0.0, 0.0, -1.0));
  const DVec3 right{1.0, 0.0, 0.0}, up{0.0, 1.0, 0.0};
  EXPECT_EQ(glm::cross(right, up), DVec3(0.0, 0.0, 1.0)) << "right-handed: +Z comes towards us";
}

TEST(Frames, TheTangentPlanesYPointsDownLikePixelRows) {
  const Vec3 up_and_right{0.25F, 0.5F, -1.0F};
  const Vec2 tangent = tangent_from_direction(up_and_right);
  EXPECT_FLOAT_EQ(tangent.x, 0.25F);
  EXPECT_FLOAT_EQ(tangent.y, -0.5F);
  EXPECT_EQ(direction_from_tangent(tangent), up_and_right);
}

TEST(Frames, AFovsTopEdgeHasTheLeastTangentY) {
  const Fov fov{Degrees{-40.0}, Degrees{45.0}, Degrees{50.0}, Degrees{-45.0}};
  EXPECT_NEAR(fov.tangent_min().y, -std::tan(Radians{Degrees{50.0}}.value()), 1e-15);
  EXPECT_NEAR(fov.tangent_max().y, 1.0, 1e-15);
  EXPECT_LT(fov.tangent_min().x, fov.tangent_max().x);
}

TEST(Fov, IsValidOnlyForFiniteOrderedAnglesBelowNinetyDegrees) {
  const Fov good{Degrees{-40.0}, Degrees{40.0}, Degrees{40.0}, Degrees{-40.0}};
  EXPECT_TRUE(is_valid(good));
  for (const double bad : {90.0, 180.0, -50.0, std::numeric_limits<double>::quiet_NaN()}) {
    Fov fov = good;
    fov.right = Degrees{bad};
    EXPECT_FALSE(is_valid(fov)) << bad;
  }
}

TEST(Fov, SymmetricFovHasSquarePixels) {
  const Fov fov = symmetric_fov(Degrees{90.0}, 2.0);
  EXPECT_NEAR(fov.tangent_max().x, 2.0, 1e-12);
  EXPECT_NEAR(fov.tangent_max().y, 1.0, 1e-12);
}

}  // namespace
}  // namespace macula::math
