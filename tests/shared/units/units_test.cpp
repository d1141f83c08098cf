#include <gtest/gtest.h>

#include <numbers>
#include <type_traits>

#include "shared/units/angle.h"
#include "shared/units/length.h"
#include "shared/units/time.h"

namespace macula::units {
namespace {

using namespace std::chrono_literals;

TEST(Angle, DegreesAndRadiansConvertByThemselves) {
  const Radians half_turn = Degrees{180.0};
  EXPECT_DOUBLE_EQ(half_turn.value(), std::numbers::pi);
  const Degrees back = half_turn;
  EXPECT_DOUBLE_EQ(back.value(), 180.0);
}

TEST(Angle, BareNumbersNeitherBecomeAnglesNorComeOutOfThem) {
  static_assert(!std::is_convertible_v<double, Degrees>);
  static_assert(!std::is_convertible_v<double, Radians>);
  static_assert(!std::is_convertible_v<Degrees, double>);
  EXPECT_LT(Degrees{89.0}, Degrees{90.0});
}

TEST(Time, ServerTimeAndClientTimeCannotBeMixed) {
  static_assert(!std::is_convertible_v<ServerTime, ClientTime>);
  static_assert(!std::is_constructible_v<ClientTime, ServerTime>);
  EXPECT_EQ(ServerTime{5ms} - ServerTime{2ms}, 3ms);
}

TEST(Time, MillisecondsRoundToTheNearestNanosecondOnBothSidesOfZero) {
  EXPECT_EQ(from_ms(1.0000004), 1000000ns);
  EXPECT_EQ(from_ms(-0.0000006), -1ns);
  EXPECT_DOUBLE_EQ(to_ms(1500us), 1.5);
  EXPECT_EQ(from_s(2.0), 2s);
}

}  // namespace
}  // namespace macula::units
