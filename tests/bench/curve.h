// A baseline's curve over its own settings, to be read at another method's time or error. Pure.
#pragma once

#include <optional>
#include <vector>

namespace macula::bench {

/// Straight in the logarithms between the points of a falling curve; beyond its ends it goes on as
/// 1 / x, as variance falls with time: an end that noise or bias have bent tells nothing.
class Curve {
 public:
  struct Point {
    double x, y;
  };
  explicit Curve(std::vector<Point> points);
  /// nullopt: fewer than two points, or a value that has no logarithm.
  std::optional<double> at(double x) const;
  /// Whether x lies between measured points.
  bool spans(double x) const;

 private:
  std::vector<Point> points_;  ///< x ascending
};

}  // namespace macula::bench
