// Meters as a type, for interfaces; positions are vectors in meters by convention (frames.h).
#pragma once

#include <compare>

namespace macula::units {

class Meters {
 public:
  constexpr Meters() = default;
  constexpr explicit Meters(double meters) : value_(meters) {}
  constexpr double value() const { return value_; }
  friend constexpr auto operator<=>(Meters, Meters) = default;
  friend constexpr Meters operator+(Meters a, Meters b) { return Meters{a.value_ + b.value_}; }
  friend constexpr Meters operator-(Meters a, Meters b) { return Meters{a.value_ - b.value_}; }
  friend constexpr Meters operator*(double s, Meters a) { return Meters{s * a.value_}; }

 private:
  double value_ = 0.0;
};

}  // namespace macula::units

namespace macula {
using units::Meters;
}
