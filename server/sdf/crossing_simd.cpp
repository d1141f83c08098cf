#include "server/sdf/crossing.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/sdf/crossing_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"
#include "server/sdf/marks-inl.h"

HWY_BEFORE_NAMESPACE();
namespace macula::sdf::HWY_NAMESPACE {

HWY_INLINE HWY_ATTR IntVec phase_vector(CrossingPhase phase) {
  return hn::Set(Ints(), static_cast<std::int32_t>(phase));
}

HWY_ATTR void aim_vectors(Crossings& rays, std::size_t count, float hit_m, PointBatch& next) {
  const Floats d;
  const Ints di;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto phase = hn::Load(di, rays.phase + i);
    const auto is_new = hn::RebindMask(d, hn::Eq(phase, phase_vector(CrossingPhase::New)));
    const auto mark = hn::Load(d, rays.mark + i), f_mark = hn::Load(d, rays.f_low + i);
    const auto spacing = mark_spacing(mark, hn::Load(d, rays.width + i), set(hit_m));
    const auto below = hn::Le(f_mark, hn::Zero(d));
    const auto first = hn::IfThenElse(below, hn::Sub(mark, spacing), hn::Add(mark, spacing));
    const auto begun =
        hn::IfThenElse(hn::RebindMask(di, below), phase_vector(CrossingPhase::Behind),
                       phase_vector(CrossingPhase::Ahead));
    const auto renew = [&](FloatVec fresh, float* of) HWY_ATTR {
      const auto value = hn::IfThenElse(is_new, fresh, hn::Load(d, of + i));
      hn::Store(value, d, of + i);
      return value;
    };
    renew(mark, rays.low);
    renew(mark, rays.high);
    renew(f_mark, rays.f_high);
    renew(spacing, rays.step);
    renew(spacing, rays.least);
    const auto at = renew(first, rays.at);
    hn::Store(hn::IfThenElse(hn::RebindMask(di, is_new), begun, phase), di, rays.phase + i);
    hn::Store(hn::Mul(at, hn::Load(d, rays.x + i)), d, next.x + i);
    hn::Store(hn::Mul(at, hn::Load(d, rays.y + i)), d, next.y + i);
    hn::Store(hn::Mul(at, hn::Load(d, rays.z + i)), d, next.z + i);
  }
}

HWY_ATTR void take_vectors(Crossings& rays, std::size_t count, const DistanceBatch& found) {
  const Floats d;
  const Ints di;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto phase = hn::Load(di, rays.phase + i);
    const auto is = [&](CrossingPhase which)
                        HWY_ATTR { return hn::RebindMask(d, hn::Eq(phase, phase_vector(which))); };
    const auto ahead = is(CrossingPhase::Ahead), behind = is(CrossingPhase::Behind);
    const auto mark = hn::Load(d, rays.mark + i), least = hn::Load(d, rays.least + i);
    const auto at = hn::Load(d, rays.at + i), f = hn::Load(d, found.at + i);
    const auto above = hn::Gt(f, hn::Zero(d));
    const auto low = hn::IfThenElse(above, at, hn::Load(d, rays.low + i));
    const auto f_low = hn::IfThenElse(above, f, hn::Load(d, rays.f_low + i));
    const auto high = hn::IfThenElse(above, hn::Load(d, rays.high + i), at);
    const auto f_high = hn::IfThenElse(above, hn::Load(d, rays.f_high + i), f);

    const auto step = hn::Load(d, rays.step + i);
    const auto onward = hn::And(ahead, above);  // no end is known to be below
    const auto then = hn::Mul(step, hn::IfThenElse(onward, set(2.0F), set(0.5F)));
    const auto ask = hn::Add(low, then);
    const auto beyond = hn::Gt(hn::Sub(ask, mark), hn::Mul(set(kCrossingReach), mark));
    const auto narrow = hn::AndNot(onward, hn::Le(step, least));
    const auto touches = hn::Or(hn::And(onward, beyond), hn::AndNot(above, behind));
    const auto line = hn::MulAdd(hn::Sub(high, low), hn::Div(f_low, hn::Sub(f_low, f_high)), low);
    // A field that is no number there leaves the mark.
    const auto lies = hn::And(hn::Ge(line, low), hn::Le(line, high));
    const auto ends = hn::Or(narrow, touches);
    const auto end = hn::IfThenElse(hn::AndNot(touches, lies), line, mark);

    hn::Store(low, d, rays.low + i);
    hn::Store(high, d, rays.high + i);
    hn::Store(f_low, d, rays.f_low + i);
    hn::Store(f_high, d, rays.f_high + i);
    hn::Store(then, d, rays.step + i);
    hn::Store(hn::IfThenElse(ends, end, ask), d, rays.at + i);
    const auto going =
        hn::IfThenElse(hn::RebindMask(di, onward), phase_vector(CrossingPhase::Ahead),
                       phase_vector(CrossingPhase::Between));
    const auto ended =
        hn::IfThenElse(hn::RebindMask(di, touches), phase_vector(CrossingPhase::Touch),
                       phase_vector(CrossingPhase::Found));
    hn::Store(hn::IfThenElse(hn::RebindMask(di, ends), ended, going), di, rays.phase + i);
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

HWY_EXPORT(aim_vectors);
HWY_EXPORT(take_vectors);
HWY_EXPORT(normal_vectors);

void aim_crossings(Crossings& rays, std::size_t count, float hit_m, PointBatch& next) {
  HWY_DYNAMIC_DISPATCH(aim_vectors)(rays, count, hit_m, next);
}
void take_crossings(Crossings& rays, std::size_t count, const DistanceBatch& found) {
  HWY_DYNAMIC_DISPATCH(take_vectors)(rays, count, found);
}
void make_normals(SurfaceBatch& surfaces, std::size_t count) {
  HWY_DYNAMIC_DISPATCH(normal_vectors)(surfaces, count);
}

}  // namespace macula::sdf
#endif
