// Angles as types. Construction and extraction are explicit; degrees and radians convert by
// themselves, in double.
#pragma once

#include <compare>
#include <numbers>

namespace macula::units {

class Degrees;

class Radians {
 public:
  constexpr Radians() = default;
  constexpr explicit Radians(double radians) : value_(radians) {}
  constexpr Radians(Degrees degrees);
  constexpr double value() const { return value_; }
  friend constexpr auto operator<=>(Radians, Radians) = default;
  friend constexpr Radians operator+(Radians a, Radians b) { return Radians{a.value_ + b.value_}; }
  friend constexpr Radians operator-(Radians a, Radians b) { return Radians{a.value_ - b.value_}; }
  friend constexpr Radians operator*(double s, Radians a) { return Radians{s * a.value_}; }
  constexpr Radians operator-() const { return Radians{-value_}; }

 private:
  double value_ = 0.0;
};

class Degrees {
 public:
  constexpr Degrees() = default;
  constexpr explicit Degrees(double degrees) : value_(degrees) {}
  constexpr Degrees(Radians radians) : value_(radians.value() * (180.0 / std::numbers::pi)) {}
  constexpr double value() const { return value_; }
  friend constexpr auto operator<=>(Degrees, Degrees) = default;
  friend constexpr Degrees operator+(Degrees a, Degrees b) { return Degrees{a.value_ + b.value_}; }
  friend constexpr Degrees operator-(Degrees a, Degrees b) { return Degrees{a.value_ - b.value_}; }
  friend constexpr Degrees operator*(double s, Degrees a) { return Degrees{s * a.value_}; }
  constexpr Degrees operator-() const { return Degrees{-value_}; }

 private:
  double value_ = 0.0;
};

constexpr Radians::Radians(Degrees degrees)
    : value_(degrees.value() * (std::numbers::pi / 180.0)) {}

}  // namespace macula::units

namespace macula {
using units::Degrees;
using units::Radians;
}  // namespace macula
