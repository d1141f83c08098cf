// Three floats side by side in every lane of the target's vectors, for the *_simd.cpp of any room:
// to be included below hwy/highway.h, once for every target. Loads and stores are whole vectors of
// a batch (batch.h).
#if defined(MACULA_SAMPLING_VECTORS_SIMD_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MACULA_SAMPLING_VECTORS_SIMD_H
#undef MACULA_SAMPLING_VECTORS_SIMD_H
#else
#define MACULA_SAMPLING_VECTORS_SIMD_H
#endif

#include "hwy/highway.h"
#include "server/sampling/batch.h"

HWY_BEFORE_NAMESPACE();
namespace macula::sampling::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::ScalableTag<float>;
using Ints = hn::RebindToSigned<Floats>;
using Words = hn::RebindToUnsigned<Floats>;
using FloatVec = hn::Vec<Floats>;
using IntVec = hn::Vec<Ints>;
using WordVec = hn::Vec<Words>;

struct Vec3s {
  FloatVec x, y, z;
};
HWY_INLINE HWY_ATTR Vec3s load(const Vec3Batch& from, std::size_t i) {
  const Floats d;
  return {hn::Load(d, from.x + i), hn::Load(d, from.y + i), hn::Load(d, from.z + i)};
}
HWY_INLINE HWY_ATTR void store(const Vec3s& v, Vec3Batch& to, std::size_t i) {
  const Floats d;
  hn::Store(v.x, d, to.x + i);
  hn::Store(v.y, d, to.y + i);
  hn::Store(v.z, d, to.z + i);
}
HWY_INLINE HWY_ATTR Vec3s broadcast(const Vec3& v) {
  const Floats d;
  return {hn::Set(d, v.x), hn::Set(d, v.y), hn::Set(d, v.z)};
}
HWY_INLINE HWY_ATTR Vec3s scaled(FloatVec factor, const Vec3s& v) {
  return {hn::Mul(factor, v.x), hn::Mul(factor, v.y), hn::Mul(factor, v.z)};
}
/// Zero where `mask` is not set, whatever the factors are.
template <class Mask>
HWY_INLINE HWY_ATTR Vec3s scaled_where(Mask mask, FloatVec factor, const Vec3s& v) {
  return {hn::IfThenElseZero(mask, hn::Mul(factor, v.x)),
          hn::IfThenElseZero(mask, hn::Mul(factor, v.y)),
          hn::IfThenElseZero(mask, hn::Mul(factor, v.z))};
}
HWY_INLINE HWY_ATTR Vec3s plus(const Vec3s& a, const Vec3s& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE HWY_ATTR Vec3s minus(const Vec3s& a, const Vec3s& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
/// a + s b
HWY_INLINE HWY_ATTR Vec3s plus(const Vec3s& a, FloatVec s, const Vec3s& b) {
  return {hn::MulAdd(s, b.x, a.x), hn::MulAdd(s, b.y, a.y), hn::MulAdd(s, b.z, a.z)};
}
HWY_INLINE HWY_ATTR FloatVec dot(const Vec3s& a, const Vec3s& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}

/// The three floats from `row` on of a table, a row a lane.
HWY_INLINE HWY_ATTR Vec3s gather_three(const float* rows, IntVec row) {
  const Floats d;
  return {hn::GatherIndex(d, rows, row), hn::GatherIndex(d, rows + 1, row),
          hn::GatherIndex(d, rows + 2, row)};
}

}  // namespace macula::sampling::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // one target's copy
