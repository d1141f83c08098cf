#include "shared/foveation/eccentricity.h"

#include <gtest/gtest.h>

#include <cmath>

#include "shared/foveation/gaze_filter.h"

namespace macula::foveation {
namespace {

DVec3 turned_deg(double yaw_deg) {
  const double yaw = Radians{Degrees{yaw_deg}}.value();
  return {std::sin(yaw), 0.0, -std::cos(yaw)};
}

TEST(Eccentricity, IsExactAtKnownAngles) {
  const DVec3 gaze{0.0, 0.0, -1.0};
  for (const double degrees : {0.0, 1e-7, 30.0, 89.5, 90.0, 179.0, 180.0}) {
    EXPECT_NEAR(Degrees{eccentricity(gaze, turned_deg(degrees))}.value(), degrees, 1e-6) << degrees;
  }
}

TEST(Eccentricity, IsSymmetricAndIndependentOfScale) {
  const DVec3 a = turned_deg(12.0), b{0.3, -0.4, -0.9};
  EXPECT_DOUBLE_EQ(eccentricity(a, b).value(), eccentricity(b, a).value());
  EXPECT_NEAR(eccentricity(1e6 * a, 1e-6 * b).value(), eccentricity(a, b).value(), 1e-14);
}

TEST(Eccentricity, ResolvesAnglesThatAcosCannot) {
  // acos(1 - e^2/2) in double is blind below 1.5e-8 rad.
  EXPECT_NEAR(eccentricity(DVec3(0.0, 0.0, -1.0), DVec3(1e-9, 0.0, -1.0)).value(), 1e-9, 1e-18);
}

TEST(GazeFilter, HoldsTheLastValidGazeAndStartsFromTheAxis) {
  GazeFilter filter;
  const float nan = std::nanf("");
  EXPECT_EQ(filter.update({.direction = {nan, 0.0F, -1.0F}}).direction, Vec3(0.0F, 0.0F, -1.0F));
  const Gaze good = filter.update({.direction = {0.0F, 3.0F, -4.0F}});
  EXPECT_TRUE(good.valid);
  EXPECT_NEAR(good.direction.y, 0.6F, 1e-6F);
  const Gaze held = filter.update({.direction = {0.0F, 0.0F, 0.0F}});
  EXPECT_FALSE(held.valid);
  EXPECT_EQ(held.direction, good.direction);
  EXPECT_EQ(filter.update({.direction = {1.0F, 0.0F, 0.0F}, .valid = false}).direction,
            good.direction);
}

}  // namespace
}  // namespace macula::foveation
