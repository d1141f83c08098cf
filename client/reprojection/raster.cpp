#include "client/reprojection/raster.h"

#include <algorithm>
#include <cmath>

namespace macula::reprojection {
namespace {

/// Triangles grow by this share of themselves, so that rounding opens no cracks between neighbours;
/// where both cover a pixel their values agree. 1e-3 of a cell is far below what can be seen.
constexpr float kGrow = 1e-3F;

/// Pixel centres to look at, both ends included; none where first > last.
struct Span {
  int first, last;
  bool empty() const { return first > last; }
};
/// Pixel centres in [low, high], widened by kGrow of the extent, within [0, size); none for NaN.
inline Span centres_between(float low, float high, int size) {
  const float grow = kGrow * (high - low) + 1e-4F;
  const float first = std::max(std::ceil(low - grow), 0.0F);
  const float last = std::min(std::floor(high + grow), static_cast<float>(size - 1));
  if (!(first <= last)) return {0, -1};
  return {static_cast<int>(first), static_cast<int>(last)};
}

/// A triangle ready to be asked at pixels; weights of its corners are affine on the screen.
class Triangle {
 public:
  Triangle(const Vertex& a, const Vertex& b, const Vertex& c)
      : a_(a), b_(b), c_(c), bx_(b.x - a.x), by_(b.y - a.y), cx_(c.x - a.x), cy_(c.y - a.y) {
    constexpr float kLeastArea_px2 = 1e-8F;  // below it the reciprocal would carry only rounding
    const float area = bx_ * cy_ - cx_ * by_;
    is_front_ = area > kLeastArea_px2;  // false for NaN
    scale_ = 1.0F / area;
  }
  bool is_front() const { return is_front_; }

  /// Writes to `at`, the fragment of pixel (x, y), if the triangle is there and nearer.
  void draw_at(float x, float y, Fragment& at) const {
    const float dx = x - a_.x, dy = y - a_.y;
    const float b = (dx * cy_ - dy * cx_) * scale_, c = (dy * bx_ - dx * by_) * scale_;
    const float a = 1.0F - b - c;
    if (!(std::min({a, b, c}) >= -kGrow)) return;
    const float inverse_depth =
        std::max(a * a_.inverse_depth + b * b_.inverse_depth + c * c_.inverse_depth, 0.0F);
    if (inverse_depth <= at.inverse_depth) return;
    at = {inverse_depth, a * a_.u + b * b_.u + c * c_.u, a * a_.v + b * b_.v + c * c_.v};
  }

 private:
  const Vertex &a_, &b_, &c_;
  float bx_, by_, cx_, cy_, scale_;
  bool is_front_;
};

template <class Draw>
void for_each_pixel(const Span& xs, const Span& ys, Fragments& out, Draw&& draw) {
  for (int y = ys.first; y <= ys.last; ++y) {
    Fragment* row = out.row(y).data();
    for (int x = xs.first; x <= xs.last; ++x) {
      draw(static_cast<float>(x), static_cast<float>(y), row[x]);
    }
  }
}

}  // namespace

void draw_triangle(const Vertex& a, const Vertex& b, const Vertex& c, Fragments& out) {
  const Triangle triangle(a, b, c);
  if (!triangle.is_front()) return;
  const Span xs =
      centres_between(std::min({a.x, b.x, c.x}), std::max({a.x, b.x, c.x}), out.width());
  const Span ys =
      centres_between(std::min({a.y, b.y, c.y}), std::max({a.y, b.y, c.y}), out.height());
  for_each_pixel(xs, ys, out, [&](float x, float y, Fragment& at) { triangle.draw_at(x, y, at); });
}

void draw_quad(const Vertex& upper_left, const Vertex& upper_right, const Vertex& lower_left,
               const Vertex& lower_right, Fragments& out) {
  const auto [x0, x1] = std::minmax({upper_left.x, upper_right.x, lower_left.x, lower_right.x});
  const auto [y0, y1] = std::minmax({upper_left.y, upper_right.y, lower_left.y, lower_right.y});
  const Span xs = centres_between(x0, x1, out.width()), ys = centres_between(y0, y1, out.height());
  if (xs.empty() || ys.empty()) return;
  const Triangle first(upper_left, upper_right, lower_left);
  const Triangle second(lower_right, lower_left, upper_right);
  if (first.is_front() && second.is_front()) {
    for_each_pixel(xs, ys, out, [&](float x, float y, Fragment& at) {
      first.draw_at(x, y, at);
      second.draw_at(x, y, at);
    });
  } else {
    draw_triangle(upper_left, upper_right, lower_left, out);
    draw_triangle(lower_right, lower_left, upper_right, out);
  }
}

}  // namespace macula::reprojection
