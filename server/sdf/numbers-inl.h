// Vectors of numbers for the evaluator, plain (Real) or with a gradient (Dual, forward mode), and
// points made of them. Included once per SIMD target.
#if defined(MACULA_SDF_NUMBERS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MACULA_SDF_NUMBERS_INL_H
#undef MACULA_SDF_NUMBERS_INL_H
#else
#define MACULA_SDF_NUMBERS_INL_H
#endif

#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace macula::sdf::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::ScalableTag<float>;
using Ints = hn::RebindToSigned<Floats>;
using Words = hn::RebindToUnsigned<Floats>;
using FloatVec = hn::Vec<Floats>;
using IntVec = hn::Vec<Ints>;
using WordVec = hn::Vec<Words>;
using FloatMask = hn::Mask<Floats>;

HWY_INLINE HWY_ATTR FloatVec set(float value) {
  return hn::Set(Floats(), value);
}

struct Real {
  FloatVec v;
  static constexpr std::size_t kPlanes = 1;
};
/// A value and its gradient by the point asked for.
struct Dual {
  FloatVec v, x, y, z;
  static constexpr std::size_t kPlanes = 4;
};

HWY_INLINE HWY_ATTR Real load_number(Real, const float* from, std::size_t) {
  return {hn::Load(Floats(), from)};
}
HWY_INLINE HWY_ATTR Dual load_number(Dual, const float* from, std::size_t stride) {
  const Floats d;
  return {hn::Load(d, from), hn::Load(d, from + stride), hn::Load(d, from + 2 * stride),
          hn::Load(d, from + 3 * stride)};
}
HWY_INLINE HWY_ATTR void store_number(Real a, float* to, std::size_t) {
  hn::Store(a.v, Floats(), to);
}
HWY_INLINE HWY_ATTR void store_number(Dual a, float* to, std::size_t stride) {
  const Floats d;
  hn::Store(a.v, d, to);
  hn::Store(a.x, d, to + stride);
  hn::Store(a.y, d, to + 2 * stride);
  hn::Store(a.z, d, to + 3 * stride);
}

// ---- arithmetic; a FloatVec operand is a constant ----

/// The square root, correctly rounded like hn::Sqrt, of what is seldom zero. Vectors of 512 bits
/// wait a dozen cycles for each root, and formulas around one have little else to do: an estimate
/// of 14 bits, a step of Newton for it and its half reciprocal, and the rest that is left
/// (Markstein 2000, chapter 9) take half as long. Whole vectors go the plain way where a lane is
/// zero or far from one.
HWY_INLINE HWY_ATTR FloatVec root_by_products(FloatVec a) {
#if HWY_TARGET <= HWY_AVX3
  const Words dw;
  constexpr std::uint32_t kLeast = 27U << 23U, kMost = 227U << 23U;  // 2^-100, 2^100
  const auto above_least = hn::Sub(hn::BitCast(dw, a), hn::Set(dw, kLeast));
  if (HWY_UNLIKELY(!hn::AllTrue(dw, hn::Lt(above_least, hn::Set(dw, kMost - kLeast)))))
    return hn::Sqrt(a);
  const auto half = set(0.5F), estimate = hn::ApproximateReciprocalSqrt(a);
  auto root = hn::Mul(a, estimate), half_inverse = hn::Mul(half, estimate);
  const auto error = hn::NegMulAdd(half_inverse, root, half);
  root = hn::MulAdd(root, error, root);
  half_inverse = hn::MulAdd(half_inverse, error, half_inverse);
  return hn::MulAdd(half_inverse, hn::NegMulAdd(root, root, a), root);
#else
  return hn::Sqrt(a);
#endif
}

HWY_INLINE HWY_ATTR Real add(Real a, Real b) {
  return {hn::Add(a.v, b.v)};
}
HWY_INLINE HWY_ATTR Real add(Real a, FloatVec c) {
  return {hn::Add(a.v, c)};
}
HWY_INLINE HWY_ATTR Real sub(Real a, Real b) {
  return {hn::Sub(a.v, b.v)};
}
HWY_INLINE HWY_ATTR Real sub(Real a, FloatVec c) {
  return {hn::Sub(a.v, c)};
}
HWY_INLINE HWY_ATTR Real mul(Real a, Real b) {
  return {hn::Mul(a.v, b.v)};
}
HWY_INLINE HWY_ATTR Real mul(Real a, FloatVec c) {
  return {hn::Mul(a.v, c)};
}
/// a c + b
HWY_INLINE HWY_ATTR Real mul_add(Real a, FloatVec c, Real b) {
  return {hn::MulAdd(a.v, c, b.v)};
}
HWY_INLINE HWY_ATTR Real negate(Real a) {
  return {hn::Neg(a.v)};
}
HWY_INLINE HWY_ATTR Real absolute(Real a) {
  return {hn::Abs(a.v)};
}
HWY_INLINE HWY_ATTR Real lesser(Real a, Real b) {
  return {hn::Min(a.v, b.v)};
}
HWY_INLINE HWY_ATTR Real greater(Real a, Real b) {
  return {hn::Max(a.v, b.v)};
}
HWY_INLINE HWY_ATTR Real lesser(Real a, FloatVec c) {
  return {hn::Min(a.v, c)};
}
HWY_INLINE HWY_ATTR Real greater(Real a, FloatVec c) {
  return {hn::Max(a.v, c)};
}
HWY_INLINE HWY_ATTR Real choose(FloatMask mask, Real yes, Real no) {
  return {hn::IfThenElse(mask, yes.v, no.v)};
}
HWY_INLINE HWY_ATTR Real length(Real a, Real b) {
  return {hn::Sqrt(hn::MulAdd(a.v, a.v, hn::Mul(b.v, b.v)))};
}
HWY_INLINE HWY_ATTR Real length(Real a, Real b, Real c) {
  return {hn::Sqrt(hn::MulAdd(a.v, a.v, hn::MulAdd(b.v, b.v, hn::Mul(c.v, c.v))))};
}
/// Lengths that are seldom zero.
HWY_INLINE HWY_ATTR Real long_length(Real a, Real b) {
  return {root_by_products(hn::MulAdd(a.v, a.v, hn::Mul(b.v, b.v)))};
}
HWY_INLINE HWY_ATTR Real long_length(Real a, Real b, Real c) {
  return {root_by_products(hn::MulAdd(a.v, a.v, hn::MulAdd(b.v, b.v, hn::Mul(c.v, c.v))))};
}
/// The lesser of the lengths of (ax, ay) and (bx, by): roots keep the order of what is under them.
HWY_INLINE HWY_ATTR Real lesser_length(Real ax, Real ay, Real bx, Real by) {
  const auto a = hn::MulAdd(ax.v, ax.v, hn::Mul(ay.v, ay.v));
  const auto b = hn::MulAdd(bx.v, bx.v, hn::Mul(by.v, by.v));
  return {hn::Sqrt(hn::Min(a, b))};
}
HWY_INLINE HWY_ATTR Real square_root(Real a) {
  return {hn::Sqrt(hn::Max(a.v, hn::Zero(Floats())))};
}

HWY_INLINE HWY_ATTR Dual add(Dual a, Dual b) {
  return {hn::Add(a.v, b.v), hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE HWY_ATTR Dual add(Dual a, FloatVec c) {
  return {hn::Add(a.v, c), a.x, a.y, a.z};
}
HWY_INLINE HWY_ATTR Dual sub(Dual a, Dual b) {
  return {hn::Sub(a.v, b.v), hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE HWY_ATTR Dual sub(Dual a, FloatVec c) {
  return {hn::Sub(a.v, c), a.x, a.y, a.z};
}
HWY_INLINE HWY_ATTR Dual mul(Dual a, FloatVec c) {
  return {hn::Mul(a.v, c), hn::Mul(a.x, c), hn::Mul(a.y, c), hn::Mul(a.z, c)};
}
/// A gradient with another value: the chain rule at work, slope times gradient of a.
HWY_INLINE HWY_ATTR Dual chained(FloatVec value, FloatVec slope, Dual a) {
  return {value, hn::Mul(slope, a.x), hn::Mul(slope, a.y), hn::Mul(slope, a.z)};
}
/// Gradient sa * a' + sb * b'.
HWY_INLINE HWY_ATTR Dual chained(FloatVec value, FloatVec sa, Dual a, FloatVec sb, Dual b) {
  return {value, hn::MulAdd(sa, a.x, hn::Mul(sb, b.x)), hn::MulAdd(sa, a.y, hn::Mul(sb, b.y)),
          hn::MulAdd(sa, a.z, hn::Mul(sb, b.z))};
}
HWY_INLINE HWY_ATTR Dual mul(Dual a, Dual b) {
  return chained(hn::Mul(a.v, b.v), b.v, a, a.v, b);
}
HWY_INLINE HWY_ATTR Dual mul_add(Dual a, FloatVec c, Dual b) {
  return {hn::MulAdd(a.v, c, b.v), hn::MulAdd(a.x, c, b.x), hn::MulAdd(a.y, c, b.y),
          hn::MulAdd(a.z, c, b.z)};
}
HWY_INLINE HWY_ATTR Dual negate(Dual a) {
  return {hn::Neg(a.v), hn::Neg(a.x), hn::Neg(a.y), hn::Neg(a.z)};
}
HWY_INLINE HWY_ATTR Dual choose(FloatMask mask, Dual yes, Dual no) {
  return {hn::IfThenElse(mask, yes.v, no.v), hn::IfThenElse(mask, yes.x, no.x),
          hn::IfThenElse(mask, yes.y, no.y), hn::IfThenElse(mask, yes.z, no.z)};
}
HWY_INLINE HWY_ATTR Dual absolute(Dual a) {
  return chained(hn::Abs(a.v), hn::CopySignToAbs(set(1.0F), a.v), a);
}
HWY_INLINE HWY_ATTR Dual lesser(Dual a, Dual b) {
  return choose(hn::Lt(a.v, b.v), a, b);
}
HWY_INLINE HWY_ATTR Dual greater(Dual a, Dual b) {
  return choose(hn::Gt(a.v, b.v), a, b);
}
HWY_INLINE HWY_ATTR Dual constant(Dual, FloatVec c) {
  const auto zero = hn::Zero(Floats());
  return {c, zero, zero, zero};
}
HWY_INLINE HWY_ATTR Real constant(Real, FloatVec c) {
  return {c};
}
/// Where both are equal the gradient is a's: distances inside solids end at zero.
HWY_INLINE HWY_ATTR Dual lesser(Dual a, FloatVec c) {
  return choose(hn::Le(a.v, c), a, constant(a, c));
}
HWY_INLINE HWY_ATTR Dual greater(Dual a, FloatVec c) {
  return greater(a, constant(a, c));
}
/// Where a length is zero its gradient is too.
HWY_INLINE HWY_ATTR FloatVec inverse_length(FloatVec length) {
  return hn::Div(set(1.0F), hn::Max(length, set(1e-30F)));
}
HWY_INLINE HWY_ATTR Dual length(Dual a, Dual b) {
  const auto value = length(Real{a.v}, Real{b.v}).v, inverse = inverse_length(value);
  return chained(value, hn::Mul(a.v, inverse), a, hn::Mul(b.v, inverse), b);
}
HWY_INLINE HWY_ATTR Dual length(Dual a, Dual b, Dual c) {
  const auto value = length(Real{a.v}, Real{b.v}, Real{c.v}).v, inverse = inverse_length(value);
  const Dual two = chained(value, hn::Mul(a.v, inverse), a, hn::Mul(b.v, inverse), b);
  const Dual third = chained(value, hn::Mul(c.v, inverse), c);
  return {value, hn::Add(two.x, third.x), hn::Add(two.y, third.y), hn::Add(two.z, third.z)};
}
HWY_INLINE HWY_ATTR Dual long_length(Dual a, Dual b) {
  return length(a, b);
}
HWY_INLINE HWY_ATTR Dual long_length(Dual a, Dual b, Dual c) {
  return length(a, b, c);
}
HWY_INLINE HWY_ATTR Dual lesser_length(Dual ax, Dual ay, Dual bx, Dual by) {
  return lesser(length(ax, ay), length(bx, by));
}
HWY_INLINE HWY_ATTR Dual square_root(Dual a) {
  const auto value = square_root(Real{a.v}).v;
  return chained(value, hn::Mul(set(0.5F), inverse_length(value)), a);
}

// ---- sine ----

/// Within 2e-7 for |x| up to 1e4: x minus a multiple of pi, an odd polynomial of degree 11 (Taylor,
/// error below 6e-8 on [-pi/2, pi/2]), and the multiple's parity for the sign.
HWY_INLINE HWY_ATTR FloatVec sine(FloatVec x) {
  const Ints di;
  const auto turns = hn::Round(hn::Mul(x, set(0.318309886F)));
  auto y = hn::NegMulAdd(turns, set(3.140625F), x);
  y = hn::NegMulAdd(turns, set(9.67653589793e-4F), y);
  const auto odd = hn::ShiftLeft<31>(hn::NearestInt(turns));
  const auto z = hn::Mul(y, y);
  auto p = hn::MulAdd(z, set(-2.50521084e-8F), set(2.75573192e-6F));
  p = hn::MulAdd(z, p, set(-1.98412698e-4F));
  p = hn::MulAdd(z, p, set(8.33333333e-3F));
  p = hn::MulAdd(z, p, set(-1.66666667e-1F));
  const auto value = hn::MulAdd(hn::Mul(z, y), p, y);
  return hn::BitCast(Floats(), hn::Xor(hn::BitCast(di, value), odd));
}
HWY_INLINE HWY_ATTR FloatVec cosine(FloatVec x) {
  return sine(hn::Add(x, set(1.57079633F)));
}
HWY_INLINE HWY_ATTR Real sine(Real a) {
  return {sine(a.v)};
}
HWY_INLINE HWY_ATTR Dual sine(Dual a) {
  return chained(sine(a.v), cosine(a.v), a);
}
HWY_INLINE HWY_ATTR Real cosine(Real a) {
  return {cosine(a.v)};
}
HWY_INLINE HWY_ATTR Dual cosine(Dual a) {
  return chained(cosine(a.v), hn::Neg(sine(a.v)), a);
}

// ---- points ----

template <class N>
struct Point {
  N x, y, z;
};

template <class N>
HWY_INLINE HWY_ATTR Point<N> load_point(const float* from, std::size_t stride) {
  const std::size_t axis = N::kPlanes * stride;
  return {load_number(N{}, from, stride), load_number(N{}, from + axis, stride),
          load_number(N{}, from + 2 * axis, stride)};
}
template <class N>
HWY_INLINE HWY_ATTR void store_point(const Point<N>& p, float* to, std::size_t stride) {
  const std::size_t axis = N::kPlanes * stride;
  store_number(p.x, to, stride);
  store_number(p.y, to + axis, stride);
  store_number(p.z, to + 2 * axis, stride);
}

/// Three constants, the same in every lane.
struct Triple {
  FloatVec x, y, z;
};
HWY_INLINE HWY_ATTR Triple triple(const float* k) {
  return {set(k[0]), set(k[1]), set(k[2])};
}
template <class N>
HWY_INLINE HWY_ATTR Point<N> sub(const Point<N>& p, const Triple& c) {
  return {sub(p.x, c.x), sub(p.y, c.y), sub(p.z, c.z)};
}

}  // namespace macula::sdf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
