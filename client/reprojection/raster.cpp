#include "client/reprojection/raster.h"

#include <algorithm>
#include <cmath>

#include "client/reprojection/raster_rules.h"

namespace macula::reprojection {
namespace {

/// Pixel centres to look at, both ends included; none where first > last.
struct Span {
  int first, last;
  bool empty() const { return first > last; }
};
/// Pixel centres in [low, high], widened by kGrow of the extent, within [begin, end); none for NaN.
inline Span centres_between(float low, float high, int begin, int end) {
  const float grow = kGrow * (high - low) + kGrow_px;
  const float first = std::max(std::ceil(low - grow), static_cast<float>(begin));
  const float last = std::min(std::floor(high + grow), static_cast<float>(end - 1));
  if (!(first <= last)) return {0, -1};
  return {static_cast<int>(first), static_cast<int>(last)};
}

/// A triangle ready to be asked at pixels; weights of its corners are affine on the screen.
class Triangle {
 public:
  Triangle(const Vertex& a, const Vertex& b, const Vertex& c)
      : a_(a), b_(b), c_(c), bx_(b.x - a.x), by_(b.y - a.y), cx_(c.x - a.x), cy_(c.y - a.y) {
    const float area = bx_ * cy_ - cx_ * by_;
    is_front_ = area > kLeastArea_px2;  // false for NaN
    scale_ = 1.0F / area;
  }
  bool is_front() const { return is_front_; }

  /// Writes to pixel (x, y) if the triangle is there and nearer.
  void draw_at(int column, int row, Fragments& out) const {
    const float dx = static_cast<float>(column) - a_.x, dy = static_cast<float>(row) - a_.y;
    const float b = (dx * cy_ - dy * cx_) * scale_, c = (dy * bx_ - dx * by_) * scale_;
    const float a = 1.0F - b - c;
    if (!(std::min({a, b, c}) >= -kGrow)) return;
    const float inverse_depth =
        std::max(a * a_.inverse_depth + b * b_.inverse_depth + c * c_.inverse_depth, 0.0F);
    if (inverse_depth <= out.inverse_depth(column, row)) return;
    out.set(column, row,
            {inverse_depth, a * a_.u + b * b_.u + c * c_.u, a * a_.v + b * b_.v + c * c_.v});
  }

 private:
  const Vertex &a_, &b_, &c_;
  float bx_, by_, cx_, cy_, scale_;
  bool is_front_;
};

template <class Draw>
void for_each_pixel(const Span& xs, const Span& ys, Draw&& draw) {
  for (int y = ys.first; y <= ys.last; ++y) {
    for (int x = xs.first; x <= xs.last; ++x) draw(x, y);
  }
}

}  // namespace

void draw_triangle(const Vertex& a, const Vertex& b, const Vertex& c, Fragments& out) {
  const Triangle triangle(a, b, c);
  if (!triangle.is_front()) return;
  const Span xs =
      centres_between(std::min({a.x, b.x, c.x}), std::max({a.x, b.x, c.x}), 0, out.width());
  const Span ys = centres_between(std::min({a.y, b.y, c.y}), std::max({a.y, b.y, c.y}),
                                  out.first_row(), out.end_row());
  for_each_pixel(xs, ys, [&](int x, int y) { triangle.draw_at(x, y, out); });
}

void draw_quad(const Vertex& upper_left, const Vertex& upper_right, const Vertex& lower_left,
               const Vertex& lower_right, Fragments& out) {
  const auto least = [](float a, float b, float c, float d) {
    return std::min(std::min(a, b), std::min(c, d));
  };
  const auto most = [](float a, float b, float c, float d) {
    return std::max(std::max(a, b), std::max(c, d));
  };
  const Span xs = centres_between(least(upper_left.x, upper_right.x, lower_left.x, lower_right.x),
                                  most(upper_left.x, upper_right.x, lower_left.x, lower_right.x), 0,
                                  out.width());
  if (xs.empty()) return;
  const Span ys = centres_between(least(upper_left.y, upper_right.y, lower_left.y, lower_right.y),
                                  most(upper_left.y, upper_right.y, lower_left.y, lower_right.y),
                                  out.first_row(), out.end_row());
  if (ys.empty()) return;
  const Triangle first(upper_left, upper_right, lower_left);
  const Triangle second(lower_right, lower_left, upper_right);
  if (first.is_front() && second.is_front()) {
    for_each_pixel(xs, ys, [&](int x, int y) {
      first.draw_at(x, y, out);
      second.draw_at(x, y, out);
    });
  } else {
    draw_triangle(upper_left, upper_right, lower_left, out);
    draw_triangle(lower_right, lower_left, upper_right, out);
  }
}

namespace {

/// Through the stretch's ends and its middle vertex.
Stretch stretch_through(const float* tangents, int count) {
  if (count == 1) return {};
  const int middle = count / 2;
  const float share = (tangents[middle] - tangents[0]) / (tangents[count] - tangents[0]);
  const float wanted = static_cast<float>(middle) / static_cast<float>(count);
  return {static_cast<float>(count), (wanted - share) / (share * (1.0F - share))};
}

}  // namespace

Stretch column_stretch(const Patch& patch, const Block& block) {
  return stretch_through(patch.x_tangents.data() + block.column, block.columns);
}
Stretch row_stretch(const Patch& patch, const Block& block) {
  return stretch_through(patch.y_tangents.data() + block.row, block.rows);
}

BlockShape shape_of(const Patch& patch, const Block& block) {
  const auto corner = [&](int column, int row) {
    const std::size_t at = Patch::at(column, row);
    return BlockShape::Corner{patch.x[at], patch.y[at], patch.inverse_depth[at],
                              patch.nearness[at]};
  };
  const int last_column = block.column + block.columns, last_row = block.row + block.rows;
  return {corner(block.column, block.row),
          corner(last_column, block.row),
          corner(block.column, last_row),
          corner(last_column, last_row),
          static_cast<float>(patch.column + block.column - 1),
          static_cast<float>(patch.layer_row + patch.row + block.row - 1),
          column_stretch(patch, block),
          row_stretch(patch, block)};
}

}  // namespace macula::reprojection
