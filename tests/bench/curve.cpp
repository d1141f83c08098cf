#include "tests/bench/curve.h"

#include <algorithm>
#include <cmath>

namespace macula::bench {
namespace {

std::optional<double> beyond(const Curve::Point& end, double x) {
  if (!(end.x > 0.0 && end.y > 0.0)) return std::nullopt;
  return end.y * end.x / x;
}

}  // namespace

Curve::Curve(std::vector<Point> points) : points_(std::move(points)) {
  std::ranges::sort(points_, {}, &Point::x);
}

bool Curve::spans(double x) const {
  return !points_.empty() && points_.front().x <= x && x <= points_.back().x;
}

std::optional<double> Curve::at(double x) const {
  if (points_.size() < 2 || !(x > 0.0)) return std::nullopt;
  const Point &first = points_.front(), &last = points_.back();
  if (x <= first.x) return beyond(first, x);
  if (x >= last.x) return beyond(last, x);
  std::size_t right = 1;
  while (points_[right].x < x) ++right;
  const Point &a = points_[right - 1], &b = points_[right];
  if (!(a.x > 0.0 && b.x > a.x && a.y > 0.0 && b.y > 0.0)) return std::nullopt;
  const double slope = std::log(b.y / a.y) / std::log(b.x / a.x);
  return a.y * std::pow(x / a.x, slope);
}

}  // namespace macula::bench
