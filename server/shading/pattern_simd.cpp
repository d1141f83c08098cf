// The scalar functions of pattern.cpp are the oracles of these.
#include "server/shading/pattern.h"
#include "server/shading/pattern_lattice.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/shading/pattern_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"
#include "server/sampling/vectors_simd.h"

HWY_BEFORE_NAMESPACE();
namespace macula::shading::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using namespace sampling::HWY_NAMESPACE;

HWY_INLINE HWY_ATTR FloatVec set(float value) {
  return hn::Set(Floats(), value);
}
HWY_INLINE HWY_ATTR FloatVec clamped(FloatVec value) {
  return hn::Min(hn::Max(value, set(0.0F)), set(1.0F));
}
HWY_INLINE HWY_ATTR FloatVec mix(FloatVec a, FloatVec b, FloatVec t) {
  return hn::MulAdd(t, hn::Sub(b, a), a);
}

HWY_INLINE HWY_ATTR FloatVec pulse_integral(FloatVec v, FloatVec duty) {
  const auto floor = hn::Floor(v);
  return hn::MulAdd(floor, duty, hn::Min(hn::Sub(v, floor), duty));
}
HWY_INLINE HWY_ATTR FloatVec pulses(FloatVec x, float duty_share, FloatVec width) {
  const auto duty = set(duty_share), half = hn::Mul(set(0.5F), width);
  const auto local = hn::Sub(x, hn::Floor(x));
  const auto gained = hn::Sub(pulse_integral(hn::Add(local, half), duty),
                              pulse_integral(hn::Sub(local, half), duty));
  const auto point = hn::IfThenElseZero(hn::Lt(local, duty), set(1.0F));
  return hn::IfThenElse(hn::Gt(width, set(0.0F)), clamped(hn::Div(gained, width)), point);
}

struct Plane2 {
  FloatVec u, v;
};
HWY_INLINE HWY_ATTR Plane2 across(const Vec3s& position, const Vec3s& normal) {
  const auto x = hn::Abs(normal.x), y = hn::Abs(normal.y), z = hn::Abs(normal.z);
  const auto up = hn::And(hn::Ge(y, x), hn::Ge(y, z));
  const auto along_z = hn::AndNot(up, hn::Ge(x, z));
  return {hn::IfThenElse(along_z, position.z, position.x),
          hn::IfThenElse(up, position.z, position.y)};
}

HWY_INLINE HWY_ATTR FloatVec checker(const Plane2& at, const Plane2& width) {
  const auto half = set(0.5F), one = set(1.0F), two = set(2.0F);
  const auto axis = [&](FloatVec x, FloatVec w) HWY_ATTR {
    return hn::MulSub(two, pulses(hn::Mul(half, x), 0.5F, hn::Mul(half, w)), one);
  };
  const auto product = hn::Mul(axis(at.u, width.u), axis(at.v, width.v));
  return hn::NegMulAdd(half, product, half);
}

HWY_INLINE HWY_ATTR FloatVec bricks(const Plane2& at, const Plane2& width) {
  const auto half = set(0.5F), one = set(1.0F);
  // Half of an odd course has a fraction of one half: the shift itself.
  const auto halves = hn::Mul(half, hn::Floor(at.v));
  const auto shift = hn::Sub(halves, hn::Floor(halves));
  const auto upright = pulses(hn::MulAdd(half, at.u, shift), 0.5F * kJoint, hn::Mul(half, width.u));
  const auto level = pulses(at.v, kJoint, width.v);
  return hn::NegMulAdd(hn::Sub(one, upright), hn::Sub(one, level), one);
}

// ---- noise ----

HWY_INLINE HWY_ATTR FloatVec lattice(WordVec x, WordVec y, WordVec z) {
  const Words dw;
  auto h = hn::Xor(hn::Xor(x, y), z);
  h = hn::Mul(hn::Xor(h, hn::ShiftRight<15>(h)), hn::Set(dw, kLatticeMix[0]));
  h = hn::Mul(hn::Xor(h, hn::ShiftRight<12>(h)), hn::Set(dw, kLatticeMix[1]));
  const auto mantissa = hn::ShiftRight<8>(hn::Xor(h, hn::ShiftRight<15>(h)));
  return hn::Mul(hn::ConvertTo(Floats(), hn::BitCast(Ints(), mantissa)), set(0x1p-24F));
}

/// One axis of a lattice cell: both corners' parts of the hash, and how far between them, faded.
struct Corners {
  WordVec low, high;
  FloatVec fade;
};
HWY_INLINE HWY_ATTR Corners corners(FloatVec x, std::uint32_t odd) {
  const auto factor = hn::Set(Words(), odd);
  const auto floor = hn::Floor(x), t = hn::Sub(x, floor);
  const auto low = hn::Mul(hn::BitCast(Words(), hn::NearestInt(floor)), factor);
  return {low, hn::Add(low, factor),
          hn::Mul(hn::Mul(t, t), hn::NegMulAdd(set(2.0F), t, set(3.0F)))};
}

HWY_INLINE HWY_ATTR FloatVec value_noise(const Vec3s& at) {
  const Corners x = corners(at.x, kLatticeX), y = corners(at.y, kLatticeY),
                z = corners(at.z, kLatticeZ);
  const auto row = [&](WordVec cy, WordVec cz) HWY_ATTR {
    return mix(lattice(x.low, cy, cz), lattice(x.high, cy, cz), x.fade);
  };
  return mix(mix(row(y.low, z.low), row(y.high, z.low), y.fade),
             mix(row(y.low, z.high), row(y.high, z.high), y.fade), z.fade);
}

HWY_INLINE HWY_ATTR FloatVec noise(const Vec3s& at, FloatVec width) {
  auto sum = set(0.5F);
  float amplitude = 2.0F / 3.0F, frequency = 1.0F;
  for (int octave = 0; octave < 2; ++octave, amplitude *= 0.5F, frequency *= 2.0F) {
    const auto seen = clamped(hn::NegMulAdd(set(2.0F * frequency), width, set(2.0F)));
    if (hn::AllFalse(Floats(), hn::Gt(seen, set(0.0F)))) continue;
    const auto value = hn::Sub(value_noise(scaled(set(frequency), at)), set(0.5F));
    sum = hn::MulAdd(hn::Mul(seen, set(amplitude)), value, sum);
  }
  return clamped(sum);
}

template <class Share>
HWY_INLINE HWY_ATTR void each_vector(const PatternPoints& points, float per_size,
                                     sampling::FloatBatch& out, Share share) {
  const Floats d;
  const auto scale = set(per_size);
  for (std::size_t i = 0; i < points.count; i += hn::Lanes(d)) {
    const Vec3s at = scaled(scale, load(points.position, i));
    const Vec3s width = scaled(scale, load(points.footprint_m, i));
    hn::Store(share(at, width, i), d, out.at + i);
  }
}

HWY_ATTR void share_vectors(const scene::Pattern& pattern, const PatternPoints& points,
                            sampling::FloatBatch& out) {
  const float per_size = 1.0F / pattern.size_m;
  switch (pattern.kind) {
    case scene::PatternKind::Checker:
      return each_vector(points, per_size, out,
                         [&](const Vec3s& at, const Vec3s& width, std::size_t i) HWY_ATTR {
                           const Vec3s normal = load(points.normal, i);
                           return checker(across(at, normal), across(width, normal));
                         });
    case scene::PatternKind::Bricks:
      return each_vector(points, per_size, out,
                         [&](const Vec3s& at, const Vec3s& width, std::size_t i) HWY_ATTR {
                           const Vec3s normal = load(points.normal, i);
                           return bricks(across(at, normal), across(width, normal));
                         });
    case scene::PatternKind::Stripes:
      return each_vector(points, per_size, out,
                         [](const Vec3s& at, const Vec3s& width, std::size_t) HWY_ATTR {
                           const auto half = set(0.5F);
                           return pulses(hn::Mul(half, at.y), 0.5F, hn::Mul(half, width.y));
                         });
    case scene::PatternKind::Noise:
      return each_vector(points, per_size, out,
                         [](const Vec3s& at, const Vec3s& width, std::size_t) HWY_ATTR {
                           return noise(at, hn::Max(width.x, hn::Max(width.y, width.z)));
                         });
  }
}

}  // namespace macula::shading::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::shading {

HWY_EXPORT(share_vectors);

void second_shares(const scene::Pattern& pattern, const PatternPoints& points,
                   sampling::FloatBatch& out) {
  HWY_DYNAMIC_DISPATCH(share_vectors)(pattern, points, out);
}

}  // namespace macula::shading
#endif
