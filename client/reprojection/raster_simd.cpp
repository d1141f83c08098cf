// draw_quad (raster.cpp) is the oracle of both ways here. Multiplications and additions stay apart,
// so that every instruction set gives the same bits.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "client/reprojection/raster.h"
#include "client/reprojection/raster_rules.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "client/reprojection/raster_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

#ifndef MACULA_CLIENT_REPROJECTION_RASTER_SIMD_ONCE
#define MACULA_CLIENT_REPROJECTION_RASTER_SIMD_ONCE
namespace macula::reprojection {

/// A cell over more pixels than this, sideways or upright, is drawn as a block.
inline constexpr int kMostPixels = 4;
/// How far, in cells, a block's columns and rows may lie from evenly growing steps.
inline constexpr float kUneven = 0.01F;

}  // namespace macula::reprojection
#endif  // MACULA_CLIENT_REPROJECTION_RASTER_SIMD_ONCE

HWY_BEFORE_NAMESPACE();
namespace macula::reprojection::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, 16>;
using Ints = hn::RebindToSigned<Floats>;
using F = hn::Vec<Floats>;
using Mask = hn::Mask<Floats>;

HWY_INLINE HWY_ATTR CellBits bits_of(Mask mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(Floats(), mask, bytes);
  return static_cast<CellBits>(bytes[0]) | static_cast<CellBits>(bytes[1]) << 8;
}
HWY_INLINE HWY_ATTR F set(float value) {
  return hn::Set(Floats(), value);
}
HWY_INLINE HWY_ATTR F min4(F a, F b, F c, F d) {
  return hn::Min(hn::Min(a, b), hn::Min(c, d));
}
HWY_INLINE HWY_ATTR F max4(F a, F b, F c, F d) {
  return hn::Max(hn::Max(a, b), hn::Max(c, d));
}

/// A value at the four corners of as many cells as a vector has lanes.
struct Corners {
  F upper_left, upper_right, lower_left, lower_right;
};
HWY_INLINE HWY_ATTR Corners corners_of(const float* values, int column, int row) {
  const Floats d;
  const float* upper = values + Patch::at(column, row);
  const float* lower = values + Patch::at(column, row + 1);
  return {hn::LoadU(d, upper), hn::LoadU(d, upper + 1), hn::LoadU(d, lower),
          hn::LoadU(d, lower + 1)};
}

HWY_INLINE HWY_ATTR RowRange pixel_rows_of(const Patch& patch, int row) {
  const Floats d;
  constexpr float kFar = std::numeric_limits<float>::infinity();
  F least = set(kFar), most = set(-kFar);
  for (int column = 0; column <= patch.columns; column += static_cast<int>(hn::Lanes(d))) {
    const F y = hn::Load(d, patch.y.data() + Patch::at(column, row));
    const auto seen =
        hn::And(hn::Eq(y, y), hn::FirstN(d, static_cast<std::size_t>(patch.columns + 1 - column)));
    least = hn::Min(least, hn::IfThenElse(seen, y, set(kFar)));
    most = hn::Max(most, hn::IfThenElse(seen, y, set(-kFar)));
  }
  return {hn::GetLane(hn::MinOfLanes(d, least)), hn::GetLane(hn::MaxOfLanes(d, most))};
}
HWY_ATTR void pixel_rows(const Patch& patch, VertexRows& rows) {
  for (int row = 0; row <= patch.rows; ++row) rows[row] = pixel_rows_of(patch, row);
}

HWY_ATTR CellBits cells_with_steps(const Patch& patch, int row, float step) {
  CellBits found = 0;
  for (int column = 0; column < patch.columns; column += static_cast<int>(hn::Lanes(Floats()))) {
    const Corners z = corners_of(patch.source_inverse.data(), column, row);
    const F spread = hn::Sub(max4(z.upper_left, z.upper_right, z.lower_left, z.lower_right),
                             min4(z.upper_left, z.upper_right, z.lower_left, z.lower_right));
    found |= bits_of(hn::Ge(spread, set(step))) << column;
  }
  return found;
}

// ---- many cells at a time ----

/// Half of a cell a lane: a triangle whose corners' weights are affine on the screen.
struct Triangles {
  F ax, ay, bx, by, cx, cy, scale;
  Mask front;

  HWY_INLINE HWY_ATTR Triangles(F ax_, F ay_, F b_x, F b_y, F c_x, F c_y)
      : ax(ax_),
        ay(ay_),
        bx(hn::Sub(b_x, ax_)),
        by(hn::Sub(b_y, ay_)),
        cx(hn::Sub(c_x, ax_)),
        cy(hn::Sub(c_y, ay_)) {
    const F area = hn::Sub(hn::Mul(bx, cy), hn::Mul(cx, by));
    front = hn::Gt(area, set(kLeastArea_px2));
    scale = hn::Div(set(1.0F), area);
  }
};
struct Weights {
  F a, b, c;
  Mask inside;
};
HWY_INLINE HWY_ATTR Weights weights_at(const Triangles& t, F x, F y, F grow) {
  const F dx = hn::Sub(x, t.ax), dy = hn::Sub(y, t.ay);
  Weights w;
  w.b = hn::Mul(hn::Sub(hn::Mul(dx, t.cy), hn::Mul(dy, t.cx)), t.scale);
  w.c = hn::Mul(hn::Sub(hn::Mul(dy, t.bx), hn::Mul(dx, t.by)), t.scale);
  w.a = hn::Sub(hn::Sub(set(1.0F), w.b), w.c);
  w.inside = hn::And(t.front, hn::Ge(hn::Min(w.a, hn::Min(w.b, w.c)), hn::Neg(grow)));
  return w;
}
HWY_INLINE HWY_ATTR F blend(const Weights& w, F a, F b, F c) {
  return hn::Add(hn::Add(hn::Mul(w.a, a), hn::Mul(w.b, b)), hn::Mul(w.c, c));
}

/// First pixel and number of pixels a lane covers along one axis; as centres_between.
struct Extent {
  F first, count;
};
HWY_INLINE HWY_ATTR Extent extent_of(F low, F high, int begin, int end) {
  const F grow = hn::Add(hn::Mul(set(kGrow), hn::Sub(high, low)), set(kGrow_px));
  const F first = hn::Max(hn::Ceil(hn::Sub(low, grow)), set(static_cast<float>(begin)));
  const F last = hn::Min(hn::Floor(hn::Add(high, grow)), set(static_cast<float>(end - 1)));
  const auto some = hn::Ge(last, first);  // false for NaN
  return {first, hn::IfThenElseZero(some, hn::Add(hn::Sub(last, first), set(1.0F)))};
}

/// What lanes found at one pixel each, to be written one after the other: two may meet in a pixel.
struct Found {
  alignas(64) float inverse_depth[16], u[16], v[16], x[16], y[16];
};
HWY_INLINE HWY_ATTR void write(const Found& found, CellBits lanes, Fragments& out) {
  for (; lanes != 0; lanes &= lanes - 1) {
    const int i = std::countr_zero(lanes);
    const int x = static_cast<int>(found.x[i]), y = static_cast<int>(found.y[i]);
    if (found.inverse_depth[i] <= out.inverse_depth(x, y)) continue;
    out.set(x, y, {found.inverse_depth[i], found.u[i], found.v[i]});
  }
}

/// The cells `wanted` of one vector.
HWY_INLINE HWY_ATTR CellBits draw_lanes(const Patch& patch, int column, int row, CellBits wanted,
                                        Fragments& out) {
  const Floats d;
  const Corners x = corners_of(patch.x.data(), column, row);
  const Corners y = corners_of(patch.y.data(), column, row);
  const F left = min4(x.upper_left, x.upper_right, x.lower_left, x.lower_right);
  const F right = max4(x.upper_left, x.upper_right, x.lower_left, x.lower_right);
  const F top = min4(y.upper_left, y.upper_right, y.lower_left, y.lower_right);
  const F bottom = max4(y.upper_left, y.upper_right, y.lower_left, y.lower_right);
  const Extent across = extent_of(left, right, 0, out.width());
  const Extent down = extent_of(top, bottom, out.first_row(), out.end_row());
  const auto large =
      hn::Or(hn::Gt(across.count, set(kMostPixels)), hn::Gt(down.count, set(kMostPixels)));
  const CellBits left_out =
      wanted & bits_of(hn::And(
                   large, hn::And(hn::Gt(across.count, set(0.0F)), hn::Gt(down.count, set(0.0F)))));
  wanted &= ~left_out;
  if (wanted == 0) return left_out;

  const Triangles first(x.upper_left, y.upper_left, x.upper_right, y.upper_right, x.lower_left,
                        y.lower_left);
  const Triangles second(x.lower_right, y.lower_right, x.lower_left, y.lower_left, x.upper_right,
                         y.upper_right);
  const Corners z = corners_of(patch.inverse_depth.data(), column, row);
  const F u0 = hn::Iota(d, static_cast<float>(patch.column + column - 1));
  const float v0 = static_cast<float>(patch.layer_row + patch.row + row - 1);
  Found found;
  for (int j = 0; j < kMostPixels; ++j) {
    const auto in_row = hn::Gt(down.count, set(static_cast<float>(j)));
    if ((bits_of(in_row) & wanted) == 0) break;
    const F py = hn::Add(down.first, set(static_cast<float>(j)));
    for (int i = 0; i < kMostPixels; ++i) {
      const auto in_box = hn::And(in_row, hn::Gt(across.count, set(static_cast<float>(i))));
      if ((bits_of(in_box) & wanted) == 0) break;
      const F px = hn::Add(across.first, set(static_cast<float>(i)));
      const Weights one = weights_at(first, px, py, set(kGrow));
      const Weights two = weights_at(second, px, py, set(kGrow));
      const CellBits lanes = bits_of(hn::And(in_box, hn::Or(one.inside, two.inside))) & wanted;
      if (lanes == 0) continue;
      const F none = set(-2.0F);
      const F z_one = hn::IfThenElse(
          one.inside, hn::Max(blend(one, z.upper_left, z.upper_right, z.lower_left), set(0.0F)),
          none);
      const F z_two = hn::IfThenElse(
          two.inside, hn::Max(blend(two, z.lower_right, z.lower_left, z.upper_right), set(0.0F)),
          none);
      const auto nearer = hn::Gt(z_two, z_one);
      hn::Store(hn::Max(z_one, z_two), d, found.inverse_depth);
      hn::Store(hn::Add(u0, hn::IfThenElse(nearer, hn::Sub(set(1.0F), two.b), one.b)), d, found.u);
      hn::Store(hn::Add(set(v0), hn::IfThenElse(nearer, hn::Sub(set(1.0F), two.c), one.c)), d,
                found.v);
      hn::Store(px, d, found.x);
      hn::Store(py, d, found.y);
      write(found, lanes, out);
    }
  }
  return left_out;
}

HWY_ATTR CellBits draw_cells(const Patch& patch, int row, CellBits cells, Fragments& out) {
  constexpr int kLanes = static_cast<int>(hn::MaxLanes(Floats()));
  constexpr CellBits kAll = (CellBits{1} << kLanes) - 1;
  CellBits left_out = 0;
  for (int column = 0; column < patch.columns; column += kLanes) {
    const CellBits wanted = cells >> column & kAll;
    if (wanted != 0) left_out |= draw_lanes(patch, column, row, wanted, out) << column;
  }
  return left_out;
}

// ---- one block, many pixels at a time ----

using Corner = BlockShape::Corner;

HWY_INLINE HWY_ATTR F cell_at(const Stretch& stretch, F share) {
  const F bent = hn::Mul(set(stretch.bend), hn::Mul(share, hn::Sub(set(1.0F), share)));
  return hn::Mul(set(stretch.count), hn::Add(share, bent));
}

/// A value that is affine on the screen: `origin` at the corner it is told from.
struct Affine {
  float origin, per_x, per_y;
};
/// Half of a block: a triangle from whose first corner everything is told.
struct HalfBlock {
  float x, y;
  Affine a, b, c;  ///< weights of the corners
  Affine inverse_depth;
  Affine nearness, u, v;  ///< u and v, shares of the block, times nearness
};
struct Share {
  float u, v;
};
HWY_INLINE HalfBlock half_block(const Corner& a, const Corner& b, const Corner& c, Share at_a,
                                Share at_b, Share at_c) {
  const float bx = b.x - a.x, by = b.y - a.y, cx = c.x - a.x, cy = c.y - a.y;
  const float area = bx * cy - cx * by, scale = 1.0F / area;
  HalfBlock half{};
  half.x = a.x, half.y = a.y;
  if (!(area > kLeastArea_px2)) {  // from behind: inside nowhere
    half.a = {-1.0F, 0.0F, 0.0F};
    return half;
  }
  half.b = {0.0F, cy * scale, -cx * scale};
  half.c = {0.0F, -by * scale, bx * scale};
  half.a = {1.0F, -(half.b.per_x + half.c.per_x), -(half.b.per_y + half.c.per_y)};
  const auto through = [&](float of_a, float of_b, float of_c) {
    const float to_b = of_b - of_a, to_c = of_c - of_a;
    return Affine{of_a, to_b * half.b.per_x + to_c * half.c.per_x,
                  to_b * half.b.per_y + to_c * half.c.per_y};
  };
  half.inverse_depth = through(a.inverse_depth, b.inverse_depth, c.inverse_depth);
  half.nearness = through(a.nearness, b.nearness, c.nearness);
  half.u = through(at_a.u * a.nearness, at_b.u * b.nearness, at_c.u * c.nearness);
  half.v = through(at_a.v * a.nearness, at_b.v * b.nearness, at_c.v * c.nearness);
  return half;
}

/// An affine value along one pixel row, at distances `dx` from the half's corner.
struct Along {
  float at_corner, per_x;
  HWY_INLINE HWY_ATTR F at(F dx) const { return hn::Add(set(at_corner), hn::Mul(dx, set(per_x))); }
};
HWY_INLINE Along along(const Affine& value, float dy) {
  return {value.origin + dy * value.per_y, value.per_x};
}

/// One pixel row of a half.
struct HalfRow {
  float x;
  Along a, b, c, inverse_depth, nearness, u, v;
};
HWY_INLINE HalfRow row_of(const HalfBlock& half, float y) {
  const float dy = y - half.y;
  return {half.x,
          along(half.a, dy),
          along(half.b, dy),
          along(half.c, dy),
          along(half.inverse_depth, dy),
          along(half.nearness, dy),
          along(half.u, dy),
          along(half.v, dy)};
}
HWY_INLINE HWY_ATTR Mask inside(const HalfRow& row, F dx, float grow) {
  return hn::Ge(hn::Min(row.a.at(dx), hn::Min(row.b.at(dx), row.c.at(dx))), set(-grow));
}

/// One pixel row of a block.
struct BlockRow {
  HalfRow first, second;
  float grow, right;
  float *inverse_depth, *u, *v;
};

/// Draws one vector of a row from pixel x on.
HWY_INLINE HWY_ATTR void draw_row_part(const BlockShape& shape, const BlockRow& row, float x) {
  const Floats d;
  const F xs = hn::Iota(d, x);
  const F dx1 = hn::Sub(xs, set(row.first.x)), dx2 = hn::Sub(xs, set(row.second.x));
  const auto in_first = inside(row.first, dx1, row.grow);
  const auto either =
      hn::And(hn::Le(xs, set(row.right)), hn::Or(in_first, inside(row.second, dx2, row.grow)));
  if (hn::AllFalse(d, either)) return;
  const auto value = [&](const Along& first, const Along& second) HWY_ATTR {
    return hn::IfThenElse(in_first, first.at(dx1), second.at(dx2));
  };
  const F z = hn::Max(value(row.first.inverse_depth, row.second.inverse_depth), set(0.0F));
  const std::size_t at = static_cast<std::size_t>(x);
  const F before = hn::LoadU(d, row.inverse_depth + at);
  const auto drawn = hn::And(either, hn::Gt(z, before));
  if (hn::AllFalse(d, drawn)) return;
  const F scale = hn::Div(set(1.0F), value(row.first.nearness, row.second.nearness));
  const F u = hn::Add(set(shape.u),
                      cell_at(shape.across, hn::Mul(value(row.first.u, row.second.u), scale)));
  const F v =
      hn::Add(set(shape.v), cell_at(shape.down, hn::Mul(value(row.first.v, row.second.v), scale)));
  hn::StoreU(hn::IfThenElse(drawn, z, before), d, row.inverse_depth + at);
  hn::StoreU(hn::IfThenElse(drawn, u, hn::LoadU(d, row.u + at)), d, row.u + at);
  hn::StoreU(hn::IfThenElse(drawn, v, hn::LoadU(d, row.v + at)), d, row.v + at);
}

HWY_ATTR void draw_block(const BlockShape& shape, float grow_px, Fragments& out) {
  const Corner &ul = shape.upper_left, &ur = shape.upper_right;
  const Corner &ll = shape.lower_left, &lr = shape.lower_right;
  const auto [x0, x1] = std::minmax({ul.x, ur.x, ll.x, lr.x});
  const auto [y0, y1] = std::minmax({ul.y, ur.y, ll.y, lr.y});
  const float extent_px = std::max(x1 - x0, y1 - y0);
  const float margin_px = kGrow * extent_px + kGrow_px + grow_px;
  const float left = std::max(std::ceil(x0 - margin_px), 0.0F);
  const float right = std::min(std::floor(x1 + margin_px), static_cast<float>(out.width() - 1));
  const float top = std::max(std::ceil(y0 - margin_px), static_cast<float>(out.first_row()));
  const float bottom = std::min(std::floor(y1 + margin_px), static_cast<float>(out.end_row() - 1));
  if (!(left <= right && top <= bottom)) return;  // also NaN
  const HalfBlock first = half_block(ul, ur, ll, {0, 0}, {1, 0}, {0, 1});
  const HalfBlock second = half_block(lr, ll, ur, {1, 1}, {0, 1}, {1, 0});
  BlockRow row{};
  row.grow = kGrow + grow_px / std::max(extent_px, 1.0F);
  row.right = right;
  for (int y = static_cast<int>(top); y <= static_cast<int>(bottom); ++y) {
    row.first = row_of(first, static_cast<float>(y));
    row.second = row_of(second, static_cast<float>(y));
    row.inverse_depth = out.inverse_depths(y), row.u = out.us(y), row.v = out.vs(y);
    for (float x = left; x <= right; x += static_cast<float>(hn::Lanes(Floats()))) {
      draw_row_part(shape, row, x);
    }
  }
}

// ---- how flat a block is ----

/// Where vertices 0 .. count lie between the first and the last, 0 to 1; whether `stretch` tells
/// their cells to kUneven.
HWY_INLINE HWY_ATTR bool find_shares(const float* tangents, int count, const Stretch& stretch,
                                     float* shares) {
  const Floats d;
  const float per_tangent = 1.0F / (tangents[count] - tangents[0]);
  auto even = hn::FirstN(d, hn::Lanes(d));
  for (int i = 0; i <= count; i += static_cast<int>(hn::Lanes(d))) {
    const F place = hn::Iota(d, static_cast<float>(i));
    const F share =
        hn::Mul(hn::Sub(hn::LoadU(d, tangents + i), set(tangents[0])), set(per_tangent));
    const F off = hn::Abs(hn::Sub(cell_at(stretch, share), place));
    const auto beyond = hn::Gt(place, set(static_cast<float>(count)));
    even = hn::And(even, hn::Or(beyond, hn::Le(off, set(kUneven))));
    hn::StoreU(share, d, shares + i);
  }
  return hn::AllTrue(d, even);
}

HWY_ATTR bool is_flat(const Patch& patch, const Block& block, float tolerance) {
  const Floats d;
  const auto at = [&](int i, int j) HWY_ATTR {
    return Patch::at(block.column + i * block.columns, block.row + j * block.rows);
  };
  const std::size_t corners[4] = {at(0, 0), at(1, 0), at(0, 1), at(1, 1)};
  for (const std::size_t corner : corners) {
    if (std::isnan(patch.x[corner])) return false;
  }
  alignas(64) float across[Patch::kStride], down[Patch::kStride];
  if (!find_shares(patch.x_tangents.data() + block.column, block.columns,
                   column_stretch(patch, block), across)) {
    return false;
  }
  if (!find_shares(patch.y_tangents.data() + block.row, block.rows, row_stretch(patch, block),
                   down)) {
    return false;
  }
  const float ul = patch.source_inverse[corners[0]], ur = patch.source_inverse[corners[1]],
              ll = patch.source_inverse[corners[2]], lr = patch.source_inverse[corners[3]];
  for (int j = 0; j <= block.rows; ++j) {
    const float t = down[j];
    const float* row = patch.source_inverse.data() + Patch::at(block.column, block.row + j);
    auto flat = hn::FirstN(d, hn::Lanes(d));
    for (int i = 0; i <= block.columns; i += static_cast<int>(hn::Lanes(d))) {
      const F s = hn::Load(d, across + i);
      const F one = hn::Add(set(ul + t * (ll - ul)), hn::Mul(s, set(ur - ul)));
      const F two =
          hn::Add(set(lr + (1.0F - t) * (ur - lr)), hn::Mul(hn::Sub(set(1.0F), s), set(ll - lr)));
      const F plane = hn::IfThenElse(hn::Le(hn::Add(s, set(t)), set(1.0F)), one, two);
      const auto beyond = hn::Gt(s, set(1.0F));
      const F off = hn::Abs(hn::Sub(hn::LoadU(d, row + i), plane));
      flat = hn::And(flat, hn::Or(beyond, hn::Le(off, set(tolerance))));
    }
    if (!hn::AllTrue(d, flat)) return false;
  }
  return true;
}

}  // namespace macula::reprojection::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::reprojection {

HWY_EXPORT(draw_cells);
HWY_EXPORT(draw_block);
HWY_EXPORT(cells_with_steps);
HWY_EXPORT(is_flat);
HWY_EXPORT(pixel_rows);

CellBits draw_cells(const Patch& patch, int row, CellBits cells, Fragments& out) {
  return HWY_DYNAMIC_DISPATCH(draw_cells)(patch, row, cells, out);
}
void draw_block(const BlockShape& shape, float grow_px, Fragments& out) {
  HWY_DYNAMIC_DISPATCH(draw_block)(shape, grow_px, out);
}
void pixel_rows(const Patch& patch, VertexRows& rows) {
  HWY_DYNAMIC_DISPATCH(pixel_rows)(patch, rows);
}
CellBits cells_with_steps(const Patch& patch, int row, float step) {
  return HWY_DYNAMIC_DISPATCH(cells_with_steps)(patch, row, step);
}
bool is_flat(const Patch& patch, const Block& block, float tolerance) {
  return HWY_DYNAMIC_DISPATCH(is_flat)(patch, block, tolerance);
}

}  // namespace macula::reprojection
#endif  // HWY_ONCE
