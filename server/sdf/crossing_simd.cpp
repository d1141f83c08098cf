#include "server/sdf/crossing.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/sdf/crossing_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace macula::sdf::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::ScalableTag<float>;
using Ints = hn::RebindToSigned<Floats>;
using FloatVec = hn::Vec<Floats>;

/// A distance that falls less than this along its ray has no crossing that could be foretold.
constexpr float kLeastFall = 1.0F / 256.0F;

HWY_INLINE HWY_ATTR FloatVec set(float value) {
  return hn::Set(Floats(), value);
}
HWY_INLINE HWY_ATTR void store_points(const Crossings& rays, std::size_t i, FloatVec t,
                                      PointBatch& out) {
  const Floats d;
  hn::Store(hn::Mul(t, hn::Load(d, rays.x + i)), d, out.x + i);
  hn::Store(hn::Mul(t, hn::Load(d, rays.y + i)), d, out.y + i);
  hn::Store(hn::Mul(t, hn::Load(d, rays.z + i)), d, out.z + i);
}

HWY_ATTR void choose_vectors(Crossings& rays, std::size_t count, PointBatch& low_points,
                             PointBatch& high_points) {
  const Floats d;
  const Ints di;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto at = hn::Load(d, rays.at + i);
    const auto slope = hn::Min(hn::Load(d, rays.slope + i), set(-kLeastFall));
    const auto reach = hn::Mul(set(kCrossingReach), at);
    const auto ahead = hn::Neg(hn::Div(hn::Load(d, rays.found + i), slope));
    const auto guess = hn::Add(at, hn::Max(hn::Min(ahead, reach), hn::Neg(reach)));
    const auto bits = hn::BitCast(di, guess);
    const auto first = hn::And(bits, hn::Set(di, -static_cast<std::int32_t>(kCellSteps)));
    const auto low = hn::BitCast(d, first);
    const auto high = hn::BitCast(d, hn::Add(first, hn::Set(di, kCellSteps)));
    hn::Store(low, d, rays.low + i);
    hn::Store(high, d, rays.high + i);
    store_points(rays, i, low, low_points);
    store_points(rays, i, high, high_points);
  }
}

HWY_ATTR void cross_vectors(Crossings& rays, std::size_t count, const DistanceBatch& at_low,
                            const DistanceBatch& at_high) {
  const Floats d;
  const Ints di;
  const auto zero = hn::Zero(d);
  const auto state = [&](CrossingState which)
                         HWY_ATTR { return hn::Set(di, static_cast<std::int32_t>(which)); };
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto low = hn::Load(d, rays.low + i), high = hn::Load(d, rays.high + i);
    const auto f_low = hn::Load(d, at_low.at + i), f_high = hn::Load(d, at_high.at + i);
    const auto width = hn::Sub(high, low), fall = hn::Sub(f_low, f_high);
    const auto crosses = hn::And(hn::Gt(f_low, zero), hn::Le(f_high, zero));
    const auto crossing = hn::MulAdd(width, hn::Div(f_low, fall), low);
    // Roundings may hide how the field falls over so short a way: then the way before says it.
    const auto falls = hn::Gt(fall, hn::Mul(set(kLeastFall), width));
    const auto slope =
        hn::IfThenElse(falls, hn::Neg(hn::Div(fall, width)), hn::Load(d, rays.slope + i));
    const auto line = hn::Sub(low, hn::Div(f_low, hn::Min(slope, set(-kLeastFall))));
    const auto last = hn::BitCast(d, hn::Sub(hn::BitCast(di, low), hn::Set(di, 1)));
    const auto guess =
        hn::IfThenElse(hn::Gt(f_low, zero), hn::Max(line, high), hn::Min(line, last));
    hn::Store(hn::IfThenElse(crosses, crossing, guess), d, rays.at + i);
    hn::Store(zero, d, rays.found + i);
    hn::Store(slope, d, rays.slope + i);
    hn::Store(hn::IfThenElse(hn::RebindMask(di, crosses), state(CrossingState::Found),
                             state(CrossingState::Open)),
              di, rays.state + i);
  }
}

HWY_ATTR void normal_vectors(SurfaceBatch& s, std::size_t count) {
  const Floats d;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto x = hn::Load(d, s.x + i), y = hn::Load(d, s.y + i), z = hn::Load(d, s.z + i);
    const auto square = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
    // Shorter than 1e-6 is no direction; a gradient that is not finite neither.
    const auto usable = hn::And(hn::Gt(square, set(1e-12F)), hn::Lt(square, set(1e30F)));
    const auto inverse = hn::IfThenElseZero(usable, hn::Div(set(1.0F), hn::Sqrt(square)));
    hn::Store(hn::IfThenElseZero(usable, hn::Mul(x, inverse)), d, s.x + i);
    hn::Store(hn::IfThenElseZero(usable, hn::Mul(y, inverse)), d, s.y + i);
    hn::Store(hn::IfThenElseZero(usable, hn::Mul(z, inverse)), d, s.z + i);
  }
}

}  // namespace macula::sdf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::sdf {

HWY_EXPORT(choose_vectors);
HWY_EXPORT(cross_vectors);
HWY_EXPORT(normal_vectors);

void choose_cells(Crossings& rays, std::size_t count, PointBatch& low, PointBatch& high) {
  HWY_DYNAMIC_DISPATCH(choose_vectors)(rays, count, low, high);
}
void cross_cells(Crossings& rays, std::size_t count, const DistanceBatch& low,
                 const DistanceBatch& high) {
  HWY_DYNAMIC_DISPATCH(cross_vectors)(rays, count, low, high);
}
void make_normals(SurfaceBatch& surfaces, std::size_t count) {
  HWY_DYNAMIC_DISPATCH(normal_vectors)(surfaces, count);
}

}  // namespace macula::sdf
#endif
