#include "shared/image/regions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace macula::image {
namespace {

Radians just_beyond(Degrees limit) {
  return Radians{std::nextafter(Radians{limit}.value(), 10.0)};
}

TEST(Regions, DiscsAreClosedAndTheirOutsidesOpen) {
  EXPECT_TRUE(contains(Region::F5, Degrees{5}));
  EXPECT_FALSE(contains(Region::F5, just_beyond(Degrees{5})));
  EXPECT_TRUE(contains(Region::F10, Degrees{10}));
  EXPECT_FALSE(contains(Region::F10, just_beyond(Degrees{10})));
  EXPECT_TRUE(contains(Region::F25, Degrees{25}));
  EXPECT_FALSE(contains(Region::F25, just_beyond(Degrees{25})));
}

TEST(Regions, EveryEccentricityIsInADiscOrInItsOutsideNeverInBoth) {
  for (double degrees = 0.0; degrees <= 90.0; degrees += 0.25) {
    const Radians e = Degrees{degrees};
    EXPECT_TRUE(contains(Region::All, e));
    EXPECT_NE(contains(Region::F10, e), contains(Region::Out10, e)) << degrees;
    EXPECT_NE(contains(Region::F25, e), contains(Region::Out25, e)) << degrees;
  }
}

TEST(Regions, NamesAreThoseOfTheReports) {
  EXPECT_EQ(std::string{name(Region::All)}, "all");
  EXPECT_EQ(std::string{name(Region::F5)}, "f5");
  EXPECT_EQ(std::string{name(Region::F10)}, "f10");
  EXPECT_EQ(std::string{name(Region::F25)}, "f25");
  EXPECT_EQ(std::string{name(Region::Out10)}, "out10");
  EXPECT_EQ(std::string{name(Region::Out25)}, "out25");
}

}  // namespace
}  // namespace macula::image
