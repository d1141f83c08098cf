// The marks of a ray in vectors (march.h says what they are). Included once per SIMD target.
#if defined(MACULA_SDF_MARKS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MACULA_SDF_MARKS_INL_H
#undef MACULA_SDF_MARKS_INL_H
#else
#define MACULA_SDF_MARKS_INL_H
#endif

#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace macula::sdf::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::ScalableTag<float>;
using Ints = hn::RebindToSigned<Floats>;
using FloatVec = hn::Vec<Floats>;
using IntVec = hn::Vec<Ints>;
using FloatMask = hn::Mask<Floats>;

HWY_INLINE HWY_ATTR FloatVec set(float value) {
  return hn::Set(Floats(), value);
}

/// The largest power of two that is not above a positive number.
HWY_INLINE HWY_ATTR FloatVec power_below(FloatVec positive) {
  const Ints di;
  constexpr std::int32_t kExponent = 0x7F800000;
  return hn::BitCast(Floats(), hn::And(hn::BitCast(di, positive), hn::Set(di, kExponent)));
}

/// How far apart marks lie about t >= 0: a power of two, one to two hit distances of the octave's
/// begin, but at least 16 float steps and at most a 512th of the octave.
HWY_INLINE HWY_ATTR FloatVec mark_spacing(FloatVec t, FloatVec width, FloatVec hit_m) {
  // Marks beyond 2^110 m are ever fewer float steps apart; before hit_m they stay as they are
  // there.
  const auto octave = power_below(hn::Min(hn::Max(t, hit_m), set(0x1p110F)));
  const auto close = power_below(hn::MulAdd(width, octave, hit_m));
  const auto spacing = hn::Max(hn::Add(close, close), hn::Mul(octave, set(0x1p-19F)));
  return hn::Min(spacing, hn::Mul(octave, set(0x1p-9F)));
}

/// The first mark beyond t.
HWY_INLINE HWY_ATTR FloatVec next_mark(FloatVec t, FloatVec spacing) {
  // A number this large has nothing finer than marks: adding it rounds to the nearest of them.
  const auto coarse = hn::Mul(spacing, set(0x1p23F));
  const auto nearest = hn::Sub(hn::Add(t, coarse), coarse);
  return hn::IfThenElse(hn::Gt(nearest, t), nearest, hn::Add(nearest, spacing));
}

}  // namespace macula::sdf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
