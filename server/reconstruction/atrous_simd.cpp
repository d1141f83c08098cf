#include "server/reconstruction/atrous.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/reconstruction/atrous_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

#include "hwy/contrib/math/math-inl.h"

#ifndef MACULA_ATROUS_SPLINE
#define MACULA_ATROUS_SPLINE
namespace macula::reconstruction {

/// B3 spline, at distances 0, 1 and 2.
inline constexpr float kSpline[3] = {3.0F / 8.0F, 1.0F / 4.0F, 1.0F / 16.0F};
/// Rec.709.
inline constexpr float kRed = 0.2126F, kGreen = 0.7152F, kBlue = 0.0722F;
/// Light this many e-folds beyond the noise has no weight.
inline constexpr float kFarthest = 16.0F;

}  // namespace macula::reconstruction
#endif

HWY_BEFORE_NAMESPACE();
namespace macula::reconstruction::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::ScalableTag<float>;
using FloatVec = hn::Vec<Floats>;
using FloatMask = hn::Mask<Floats>;

HWY_INLINE HWY_ATTR FloatVec luminance_of(FloatVec r, FloatVec g, FloatVec b) {
  const Floats d;
  return hn::MulAdd(hn::Set(d, kRed), r,
                    hn::MulAdd(hn::Set(d, kGreen), g, hn::Mul(hn::Set(d, kBlue), b)));
}

/// The surfaces that cells x, x + 1, ... of a row show.
struct Seen {
  FloatVec x, y, z, nx, ny, nz, distance;

  HWY_INLINE HWY_ATTR Seen(const SurfacePlanes& s, int row, int at) {
    const Floats d;
    x = hn::LoadU(d, s.x.row(row) + at), y = hn::LoadU(d, s.y.row(row) + at);
    z = hn::LoadU(d, s.z.row(row) + at), nx = hn::LoadU(d, s.normal_x.row(row) + at);
    ny = hn::LoadU(d, s.normal_y.row(row) + at), nz = hn::LoadU(d, s.normal_z.row(row) + at);
    distance = hn::LoadU(d, s.distance_m.row(row) + at);
  }
};

/// How alike surfaces are, in [0, 1]: light does not change much along a plane.
HWY_INLINE HWY_ATTR FloatVec alike(const Seen& a, const Seen& b) {
  const Floats d;
  const auto facing = hn::MulAdd(a.nx, b.nx, hn::MulAdd(a.ny, b.ny, hn::Mul(a.nz, b.nz)));
  const auto dx = hn::Sub(b.x, a.x), dy = hn::Sub(b.y, a.y), dz = hn::Sub(b.z, a.z);
  const auto off = hn::Abs(hn::MulAdd(a.nx, dx, hn::MulAdd(a.ny, dy, hn::Mul(a.nz, dz))));
  const auto between = hn::Sqrt(hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz))));
  const auto allowed = hn::MulAdd(hn::Set(d, kApartOfBetween), between,
                                  hn::Mul(hn::Set(d, kApartOfDistance), a.distance));
  const auto is_like = hn::And(hn::And(hn::Gt(b.distance, hn::Zero(d)), hn::Le(off, allowed)),
                               hn::Ge(facing, hn::Set(d, kLeastFacing)));
  const auto square = hn::Mul(facing, facing), fourth = hn::Mul(square, square);
  const auto eighth = hn::Mul(fourth, fourth);
  return hn::IfThenElseZero(is_like, hn::Mul(eighth, eighth));
}

/// Weighted sums of light.
struct Sums {
  FloatVec weight, squares, r, g, b;
};

HWY_INLINE HWY_ATTR void add(const LightPlanes& from, int y, int x, FloatVec weight, Sums& sums) {
  const Floats d;
  const auto of = [&](const WidePlane& plane) HWY_ATTR { return hn::LoadU(d, plane.row(y) + x); };
  sums.weight = hn::Add(sums.weight, weight);
  sums.squares = hn::MulAdd(hn::Mul(weight, weight), of(from.variance), sums.squares);
  sums.r = hn::MulAdd(weight, of(from.r), sums.r);
  sums.g = hn::MulAdd(weight, of(from.g), sums.g);
  sums.b = hn::MulAdd(weight, of(from.b), sums.b);
}

/// Of the variance around a cell: a single one is as noisy as what it speaks of.
HWY_INLINE HWY_ATTR FloatVec mean_variance(const WidePlane& variance, int y, int x) {
  const Floats d;
  auto sum = hn::Zero(d);
  for (int dy = -1; dy <= 1; ++dy) {
    const int row = std::clamp(y + dy, 0, variance.height() - 1);
    for (int dx = -1; dx <= 1; ++dx) {
      const float share = (dx == 0 ? 0.5F : 0.25F) * (dy == 0 ? 0.5F : 0.25F);
      sum = hn::MulAdd(hn::Set(d, share), hn::LoadU(d, variance.row(row) + x + dx), sum);
    }
  }
  return sum;
}

HWY_INLINE HWY_ATTR void smooth_at(const SurfacePlanes& surfaces, const AtrousPass& how,
                                   const LightPlanes& from, int y, int x, FloatMask wanted,
                                   LightPlanes& to) {
  const Floats d;
  const Seen mine(surfaces, y, x);
  const auto own = hn::LoadU(d, from.luminance.row(y) + x);
  const auto variance = mean_variance(from.variance, y, x);
  wanted =
      hn::And(wanted, hn::And(hn::Gt(variance, hn::Zero(d)), hn::Gt(mine.distance, hn::Zero(d))));
  const auto tolerance = hn::Div(hn::Set(d, 1.0F / how.stops),
                                 hn::Sqrt(hn::IfThenElse(wanted, variance, hn::Set(d, 1.0F))));
  Sums sums{hn::Zero(d), hn::Zero(d), hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  add(from, y, x, hn::Set(d, kSpline[0] * kSpline[0]), sums);
  for (int dy = -2; dy <= 2; ++dy) {
    const int row = y + how.step * dy;
    if (row < 0 || row >= surfaces.height()) continue;
    for (int dx = -2; dx <= 2; ++dx) {
      if (dx == 0 && dy == 0) continue;
      const int at = x + how.step * dx;
      const auto surface = alike(mine, Seen(surfaces, row, at));
      const auto apart = hn::AbsDiff(hn::LoadU(d, from.luminance.row(row) + at), own);
      const auto folds = hn::Min(hn::Mul(tolerance, apart), hn::Set(d, kFarthest));
      const float spline = kSpline[std::abs(dx)] * kSpline[std::abs(dy)];
      add(from, row, at, hn::Mul(hn::Mul(surface, hn::Set(d, spline)), hn::Exp(d, hn::Neg(folds))),
          sums);
    }
  }
  const auto scale = hn::Div(hn::Set(d, 1.0F), sums.weight);
  const auto put = [&](FloatVec value, const WidePlane& old, WidePlane& plane) HWY_ATTR {
    const auto kept = hn::LoadU(d, old.row(y) + x);
    hn::StoreU(hn::IfThenElse(wanted, value, kept), d, plane.row(y) + x);
  };
  const auto r = hn::Mul(scale, sums.r), g = hn::Mul(scale, sums.g), b = hn::Mul(scale, sums.b);
  put(r, from.r, to.r), put(g, from.g, to.g), put(b, from.b, to.b);
  put(luminance_of(r, g, b), from.luminance, to.luminance);
  put(hn::Mul(hn::Mul(scale, scale), sums.squares), from.variance, to.variance);
}

HWY_ATTR void smooth_row(const SurfacePlanes& surfaces, const WidePlane& reach, float pass,
                         const AtrousPass& how, const LightPlanes& from, int y, LightPlanes& to) {
  const Floats d;
  for (int x = 0; x < surfaces.width(); x += static_cast<int>(hn::Lanes(d))) {
    const auto wanted = hn::Gt(hn::LoadU(d, reach.row(y) + x), hn::Set(d, pass));
    smooth_at(surfaces, how, from, y, x, wanted, to);
  }
}

HWY_ATTR void cut_spikes_row(const SurfacePlanes& surfaces, const WidePlane& samples,
                             const SpikeRule& rule, const LightPlanes& from, int y,
                             LightPlanes& to) {
  const Floats d;
  for (int x = 0; x < surfaces.width(); x += static_cast<int>(hn::Lanes(d))) {
    const Seen mine(surfaces, y, x);
    const auto r = hn::LoadU(d, from.r.row(y) + x), g = hn::LoadU(d, from.g.row(y) + x);
    const auto b = hn::LoadU(d, from.b.row(y) + x);
    const auto own = luminance_of(r, g, b);
    auto most = hn::Set(d, -1.0F);
    for (int row = std::max(y - 1, 0); row <= std::min(y + 1, surfaces.height() - 1); ++row) {
      for (int at = x - 1; at <= x + 1; ++at) {
        if (row == y && at == x) continue;
        const auto like = hn::Ge(alike(mine, Seen(surfaces, row, at)), hn::Set(d, 0.5F));
        const auto bright =
            luminance_of(hn::LoadU(d, from.r.row(row) + at), hn::LoadU(d, from.g.row(row) + at),
                         hn::LoadU(d, from.b.row(row) + at));
        most = hn::IfThenElse(like, hn::Max(most, bright), most);
      }
    }
    const auto is_few = hn::Lt(hn::LoadU(d, samples.row(y) + x), hn::Set(d, rule.enough));
    most = hn::Mul(most, hn::Set(d, rule.times));
    const auto is_spike = hn::And(is_few, hn::And(hn::Ge(most, hn::Zero(d)), hn::Gt(own, most)));
    const auto scale = hn::IfThenElse(is_spike, hn::Div(most, own), hn::Set(d, 1.0F));
    hn::StoreU(hn::Mul(scale, r), d, to.r.row(y) + x);
    hn::StoreU(hn::Mul(scale, g), d, to.g.row(y) + x);
    hn::StoreU(hn::Mul(scale, b), d, to.b.row(y) + x);
    hn::StoreU(hn::Mul(scale, own), d, to.luminance.row(y) + x);
  }
}

HWY_ATTR void spread_row(const WidePlane& distance_m, const WidePlane& values, int y,
                         Spread& spread) {
  const Floats d;
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.0F);
  for (int x = 0; x < values.width(); x += static_cast<int>(hn::Lanes(d))) {
    auto count = zero, sum = zero, square = zero;
    for (int row = std::max(y - 2, 0); row <= std::min(y + 2, values.height() - 1); ++row) {
      for (int at = x - 2; at <= x + 2; ++at) {
        const auto is_lit = hn::Gt(hn::LoadU(d, distance_m.row(row) + at), zero);
        const auto value = hn::IfThenElseZero(is_lit, hn::LoadU(d, values.row(row) + at));
        count = hn::Add(count, hn::IfThenElseZero(is_lit, one));
        sum = hn::Add(sum, value);
        square = hn::MulAdd(value, value, square);
      }
    }
    const auto scale = hn::Div(one, hn::Max(count, one));
    const auto mean = hn::Mul(sum, scale);
    const auto variance = hn::Max(hn::NegMulAdd(mean, mean, hn::Mul(square, scale)), zero);
    hn::StoreU(mean, d, spread.mean.row(y) + x);
    hn::StoreU(hn::Sqrt(variance), d, spread.deviation.row(y) + x);
  }
}

}  // namespace macula::reconstruction::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::reconstruction {

HWY_EXPORT(smooth_row);
HWY_EXPORT(cut_spikes_row);
HWY_EXPORT(spread_row);

void smooth_row(const SurfacePlanes& surfaces, const WidePlane& reach, float pass,
                const AtrousPass& how, const LightPlanes& from, int y, LightPlanes& to) {
  HWY_DYNAMIC_DISPATCH(smooth_row)(surfaces, reach, pass, how, from, y, to);
}
void cut_spikes_row(const SurfacePlanes& surfaces, const WidePlane& samples, const SpikeRule& rule,
                    const LightPlanes& from, int y, LightPlanes& to) {
  HWY_DYNAMIC_DISPATCH(cut_spikes_row)(surfaces, samples, rule, from, y, to);
}
void spread_row(const WidePlane& distance_m, const WidePlane& values, int y, Spread& spread) {
  HWY_DYNAMIC_DISPATCH(spread_row)(distance_m, values, y, spread);
}

}  // namespace macula::reconstruction
#endif
