#include "client/reprojection/raster.h"

#include <algorithm>
#include <cmath>

namespace macula::reprojection {
namespace {

/// Triangles grow by this share of themselves, so that rounding opens no cracks between neighbours;
/// where both cover a pixel their values agree. 1e-3 of a cell is far below what can be seen.
constexpr float kGrow = 1e-3F;

struct Span {
  int first, last;
};
/// Pixel centres in [low, high], widened by kGrow of the extent, within [0, size).
Span centres_between(float low, float high, int size) {
  const float grow = kGrow * (high - low) + 1e-4F;
  const float first = std::max(std::ceil(low - grow), 0.0F);
  const float last = std::min(std::floor(high + grow), static_cast<float>(size - 1));
  if (!(first <= last)) return {0, -1};
  return {static_cast<int>(first), static_cast<int>(last)};
}

}  // namespace

void draw_triangle(const Vertex& a, const Vertex& b, const Vertex& c, Fragments& out) {
  constexpr float kLeastArea_px2 = 1e-8F;  // below it the reciprocal would carry only rounding
  const float bx = b.x - a.x, by = b.y - a.y, cx = c.x - a.x, cy = c.y - a.y;
  const float area = bx * cy - cx * by;
  if (!(area > kLeastArea_px2)) return;
  const Span xs =
      centres_between(std::min({a.x, b.x, c.x}), std::max({a.x, b.x, c.x}), out.width());
  const Span ys =
      centres_between(std::min({a.y, b.y, c.y}), std::max({a.y, b.y, c.y}), out.height());
  if (xs.first > xs.last || ys.first > ys.last) return;

  const float scale = 1.0F / area;
  const float bdz = b.inverse_depth - a.inverse_depth, cdz = c.inverse_depth - a.inverse_depth;
  const float bdu = b.u - a.u, cdu = c.u - a.u, bdv = b.v - a.v, cdv = c.v - a.v;
  for (int y = ys.first; y <= ys.last; ++y) {
    const float dy = static_cast<float>(y) - a.y;
    Fragment* row = out.row(y).data();
    for (int x = xs.first; x <= xs.last; ++x) {
      const float dx = static_cast<float>(x) - a.x;
      const float weight_b = (dx * cy - dy * cx) * scale, weight_c = (dy * bx - dx * by) * scale;
      if (weight_b < -kGrow || weight_c < -kGrow || weight_b + weight_c > 1.0F + kGrow) continue;
      const float inverse_depth = std::max(a.inverse_depth + weight_b * bdz + weight_c * cdz, 0.0F);
      if (inverse_depth <= row[x].inverse_depth) continue;
      row[x] = {inverse_depth, a.u + weight_b * bdu + weight_c * cdu,
                a.v + weight_b * bdv + weight_c * cdv};
    }
  }
}

}  // namespace macula::reprojection
