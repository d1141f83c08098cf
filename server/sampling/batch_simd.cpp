// The functions of sobol.h and mappings.h over batches, in vectors. The scalar functions are their
// oracles.
#include "server/sampling/mappings.h"
#include "server/sampling/sobol.h"
#include "shared/base/check.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/sampling/batch_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"
#include "server/sampling/vectors_simd.h"

HWY_BEFORE_NAMESPACE();
namespace macula::sampling::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// ---- Owen-scrambled Sobol points ----

/// Reverses the bits of every byte by looking up its halves, then the bytes of every word.
HWY_INLINE HWY_ATTR WordVec reverse_bits(WordVec x) {
  const Words d;
  const hn::Repartition<std::uint8_t, Words> db;
  alignas(16) static constexpr std::uint8_t kHighOfLow[16] = {0x00, 0x80, 0x40, 0xC0, 0x20, 0xA0,
                                                              0x60, 0xE0, 0x10, 0x90, 0x50, 0xD0,
                                                              0x30, 0xB0, 0x70, 0xF0};
  alignas(16) static constexpr std::uint8_t kLowOfHigh[16] = {0, 8, 4, 12, 2, 10, 6, 14,
                                                              1, 9, 5, 13, 3, 11, 7, 15};
  alignas(16) static constexpr std::uint8_t kBytes[16] = {3,  2,  1, 0, 7,  6,  5,  4,
                                                          11, 10, 9, 8, 15, 14, 13, 12};
  const auto nibble = hn::Set(d, 0x0F0F0F0FU);
  const auto low = hn::BitCast(db, hn::And(x, nibble));
  const auto high = hn::BitCast(db, hn::And(hn::ShiftRight<4>(x), nibble));
  const auto reversed = hn::Or(hn::TableLookupBytes(hn::LoadDup128(db, kHighOfLow), low),
                               hn::TableLookupBytes(hn::LoadDup128(db, kLowOfHigh), high));
  return hn::BitCast(d, hn::TableLookupBytes(reversed, hn::LoadDup128(db, kBytes)));
}

HWY_INLINE HWY_ATTR WordVec multiply_in(WordVec x, std::uint32_t factor) {
  return hn::Xor(x, hn::Mul(x, hn::Set(Words(), factor)));
}

HWY_INLINE HWY_ATTR WordVec laine_karras(WordVec x, WordVec seed) {
  x = multiply_in(hn::Add(x, seed), 0x6C50B47CU);
  x = multiply_in(x, 0xB82F1E52U);
  x = multiply_in(x, 0xC7AFE638U);
  return multiply_in(x, 0x8D22F6E6U);
}

template <int kShift>
HWY_INLINE HWY_ATTR WordVec fold(WordVec x, std::uint32_t lower) {
  return hn::Xor(x, hn::And(hn::ShiftRight<kShift>(x), hn::Set(Words(), lower)));
}
HWY_INLINE HWY_ATTR WordVec sobol_second_reversed(WordVec x) {
  x = fold<4>(fold<2>(fold<1>(x, 0x55555555U), 0x33333333U), 0x0F0F0F0FU);
  return fold<16>(fold<8>(x, 0x00FF00FFU), 0x0000FFFFU);
}

HWY_INLINE HWY_ATTR FloatVec unit_floats(WordVec bits) {
  const hn::RebindToSigned<Floats> di;
  const auto whole = hn::ConvertTo(Floats(), hn::BitCast(di, hn::ShiftRight<8>(bits)));
  return hn::Mul(whole, hn::Set(Floats(), 0x1p-24F));
}

HWY_ATTR void sobol_vectors(std::uint32_t index, const ScramblingBatch& sequences,
                            std::size_t count, Vec2Batch& points) {
  const Floats d;
  const Words dw;
  const auto reversed_index = reverse_bits(hn::Set(dw, index));
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto shuffled =
        reverse_bits(laine_karras(reversed_index, hn::Load(dw, sequences.order.at + i)));
    const auto x = laine_karras(shuffled, hn::Load(dw, sequences.x.at + i));
    const auto y = laine_karras(sobol_second_reversed(shuffled), hn::Load(dw, sequences.y.at + i));
    hn::Store(unit_floats(reverse_bits(x)), d, points.x + i);
    hn::Store(unit_floats(reverse_bits(y)), d, points.y + i);
  }
}

// ---- directions ----

/// Sine and cosine on [-pi/4, pi/4] by Taylor's polynomials, whose first term left out is below
/// 4e-8.
HWY_INLINE HWY_ATTR FloatVec small_sine(FloatVec a, FloatVec a2) {
  const Floats d;
  auto p = hn::MulAdd(a2, hn::Set(d, 1.0F / 362880.0F), hn::Set(d, -1.0F / 5040.0F));
  p = hn::MulAdd(a2, p, hn::Set(d, 1.0F / 120.0F));
  p = hn::MulAdd(a2, p, hn::Set(d, -1.0F / 6.0F));
  return hn::MulAdd(hn::Mul(a, a2), p, a);
}
HWY_INLINE HWY_ATTR FloatVec small_cosine(FloatVec a2) {
  const Floats d;
  auto p = hn::MulAdd(a2, hn::Set(d, 1.0F / 40320.0F), hn::Set(d, -1.0F / 720.0F));
  p = hn::MulAdd(a2, p, hn::Set(d, 1.0F / 24.0F));
  p = hn::MulAdd(a2, p, hn::Set(d, -0.5F));
  return hn::MulAdd(a2, p, hn::Set(d, 1.0F));
}

/// Malley's method on the concentric map: local directions with the normal along +Z.
HWY_INLINE HWY_ATTR Vec3s cosine_directions(FloatVec u, FloatVec v) {
  const Floats d;
  const auto one = hn::Set(d, 1.0F), zero = hn::Zero(d);
  const auto x = hn::MulSub(hn::Set(d, 2.0F), u, one);
  const auto y = hn::MulSub(hn::Set(d, 2.0F), v, one);
  const auto wide = hn::Gt(hn::Abs(x), hn::Abs(y));
  const auto radius = hn::IfThenElse(wide, x, y);
  const auto other = hn::IfThenElse(wide, y, x);
  const auto ratio = hn::IfThenElseZero(hn::Ne(radius, zero), hn::Div(other, radius));
  const auto angle = hn::Mul(hn::Set(d, 0.785398163397448F), ratio);
  const auto angle2 = hn::Mul(angle, angle);
  const auto along = hn::Mul(radius, small_cosine(angle2));
  const auto across = hn::Mul(radius, small_sine(angle, angle2));
  // In the tall half the angle counts from the y axis: sine and cosine change places.
  const auto height2 = hn::NegMulAdd(radius, radius, one);
  return {hn::IfThenElse(wide, along, across), hn::IfThenElse(wide, across, along),
          hn::Sqrt(hn::Max(height2, zero))};
}

/// frame_from_normal(normal) * local.
HWY_INLINE HWY_ATTR Vec3s to_world(const Vec3s& n, const Vec3s& local) {
  const Floats d;
  const auto one = hn::Set(d, 1.0F);
  const auto sign = hn::CopySign(one, n.z);
  const auto a = hn::Div(hn::Set(d, -1.0F), hn::Add(sign, n.z));
  const auto b = hn::Mul(hn::Mul(n.x, n.y), a);
  const auto tangent_x = hn::MulAdd(hn::Mul(sign, n.x), hn::Mul(n.x, a), one);
  const auto bitangent_y = hn::MulAdd(hn::Mul(n.y, n.y), a, sign);
  const auto x = hn::MulAdd(tangent_x, local.x, hn::MulAdd(b, local.y, hn::Mul(n.x, local.z)));
  const auto y = hn::MulAdd(hn::Mul(sign, b), local.x,
                            hn::MulAdd(bitangent_y, local.y, hn::Mul(n.y, local.z)));
  const auto down = hn::MulAdd(hn::Mul(sign, n.x), local.x, hn::Mul(n.y, local.y));
  return {x, y, hn::MulSub(n.z, local.z, down)};
}

HWY_ATTR void direction_vectors(const Vec2Batch& u, const Vec3Batch& normals,
                                const Vec3Batch& sides, std::size_t count, Vec3Batch& directions) {
  const Floats d;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const Vec3s world =
        to_world(load(normals, i), cosine_directions(hn::Load(d, u.x + i), hn::Load(d, u.y + i)));
    const Vec3s side = load(sides, i);
    const auto below = hn::Min(dot(world, side), hn::Zero(d));
    const auto lift = hn::Mul(hn::Set(d, -2.0F), below);
    store(plus(world, lift, side), directions, i);
  }
}

}  // namespace macula::sampling::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::sampling {

HWY_EXPORT(sobol_vectors);
HWY_EXPORT(direction_vectors);

void sobol_owen_2d(std::uint32_t index, const ScramblingBatch& sequences, std::size_t count,
                   Vec2Batch& points) {
  MACULA_DCHECK(count <= kBatch);
  HWY_DYNAMIC_DISPATCH(sobol_vectors)(index, sequences, count, points);
}

void cosine_directions(const Vec2Batch& u, const Vec3Batch& normals, const Vec3Batch& sides,
                       std::size_t count, Vec3Batch& directions) {
  MACULA_DCHECK(count <= kBatch);
  HWY_DYNAMIC_DISPATCH(direction_vectors)(u, normals, sides, count, directions);
}

}  // namespace macula::sampling
#endif
