// Multiplications and additions stay apart: the same bits on every instruction set.
#include <algorithm>

#include "client/reprojection/doubled_rows.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "client/reprojection/doubled_rows_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

#ifndef MACULA_CLIENT_REPROJECTION_DOUBLED_ROWS_SIMD_ONCE
#define MACULA_CLIENT_REPROJECTION_DOUBLED_ROWS_SIMD_ONCE
namespace macula::reprojection {

/// Before the first fragment of a row: a whole vector, so that loads stay aligned.
inline constexpr int kBefore = 16;

struct Row {
  float *inverse_depth, *u, *v;
};

}  // namespace macula::reprojection
#endif  // MACULA_CLIENT_REPROJECTION_DOUBLED_ROWS_SIMD_ONCE

HWY_BEFORE_NAMESPACE();
namespace macula::reprojection::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, 16>;
using F = hn::Vec<Floats>;

struct Fragments16 {
  F inverse_depth, u, v;
};
HWY_INLINE HWY_ATTR Fragments16 load(const FragmentRow& row, int x) {
  const Floats d;
  return {hn::LoadU(d, row.inverse_depth + x), hn::LoadU(d, row.u + x), hn::LoadU(d, row.v + x)};
}

/// A quarter of the way from `near` to `far` where they hang together.
HWY_INLINE HWY_ATTR Fragments16 between(const Fragments16& near, const Fragments16& far) {
  const Floats d;
  const F most = hn::Set(d, kMostApart_cells), quarter = hn::Set(d, 0.25F);
  const F across = hn::Sub(far.u, near.u), down = hn::Sub(far.v, near.v);
  const auto together = hn::And(hn::Ge(far.inverse_depth, hn::Zero(d)),
                                hn::Le(hn::Max(hn::Abs(across), hn::Abs(down)), most));
  const F step = hn::IfThenElseZero(together, quarter);
  return {near.inverse_depth, hn::Add(near.u, hn::Mul(step, across)),
          hn::Add(near.v, hn::Mul(step, down))};
}

HWY_ATTR void between_rows(const FragmentRow& near, const FragmentRow& far, int first, int end,
                           const Row& out) {
  const Floats d;
  for (int x = first; x < end; x += static_cast<int>(hn::Lanes(d))) {
    const Fragments16 made = between(load(near, x), load(far, x));
    hn::StoreU(made.inverse_depth, d, out.inverse_depth + x);
    hn::StoreU(made.u, d, out.u + x);
    hn::StoreU(made.v, d, out.v + x);
  }
}

HWY_ATTR void double_row(const FragmentRow& row, int first, int end, const Row& out) {
  const Floats d;
  for (int x = first; x < end; x += static_cast<int>(hn::Lanes(d))) {
    const Fragments16 here = load(row, x);
    const Fragments16 left = between(here, load(row, x - 1));
    const Fragments16 right = between(here, load(row, x + 1));
    hn::StoreInterleaved2(left.inverse_depth, right.inverse_depth, d, out.inverse_depth + 2 * x);
    hn::StoreInterleaved2(left.u, right.u, d, out.u + 2 * x);
    hn::StoreInterleaved2(left.v, right.v, d, out.v + 2 * x);
  }
}

}  // namespace macula::reprojection::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::reprojection {

HWY_EXPORT(between_rows);
HWY_EXPORT(double_row);

FragmentRow DoubledRows::row(const Fragments& fragments, int y, int first, int end) {
  const int width = fragments.width();
  const auto room = static_cast<std::size_t>(width + 2 * kBefore);
  for (std::vector<float>* plane : {&upright_.inverse_depth, &upright_.u, &upright_.v}) {
    plane->resize(room);
  }
  for (std::vector<float>* plane : {&inverse_depth_, &u_, &v_}) plane->resize(2 * room);
  const Row between{upright_.inverse_depth.data() + kBefore, upright_.u.data() + kBefore,
                    upright_.v.data() + kBefore};
  HWY_DYNAMIC_DISPATCH(between_rows)
  (fragments.row(y / 2), fragments.row(fragments.row_beside(y)), std::max(first - 1, 0),
   std::min(end + 1, width), between);
  between.inverse_depth[-1] = between.inverse_depth[width] = -1.0F;
  const Row doubled{inverse_depth_.data(), u_.data(), v_.data()};
  HWY_DYNAMIC_DISPATCH(double_row)
  ({between.inverse_depth, between.u, between.v}, first, end, doubled);
  return {doubled.inverse_depth, doubled.u, doubled.v};
}

}  // namespace macula::reprojection
#endif  // HWY_ONCE
