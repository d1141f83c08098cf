// What maps points to points and distances to distances: frames, repetition, turns, blends,
// displacement and the guards that keep them 1-Lipschitz. Constants in the order compile.cpp
// writes them. Included once per SIMD target.
#if defined(MACULA_SDF_WARPS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MACULA_SDF_WARPS_INL_H
#undef MACULA_SDF_WARPS_INL_H
#else
#define MACULA_SDF_WARPS_INL_H
#endif

#include "server/sdf/primitives-inl.h"

HWY_BEFORE_NAMESPACE();
namespace macula::sdf::HWY_NAMESPACE {

// ---- points from points ----

struct AffineWarp {
  const float* k;
  HWY_ATTR explicit AffineWarp(const float* constants) : k(constants) {}
  template <class N>
  HWY_INLINE HWY_ATTR N row(const Point<N>& p, const float* r) const {
    return mul_add(p.x, set(r[0]), mul_add(p.y, set(r[1]), add(mul(p.z, set(r[2])), set(r[3]))));
  }
  template <class N>
  HWY_INLINE HWY_ATTR Point<N> operator()(const Point<N>& p) const {
    return {row(p, k), row(p, k + 4), row(p, k + 8)};
  }
};

/// Negated where the sign bit is set.
HWY_INLINE HWY_ATTR Real with_sign_of(Real a, FloatVec sign) {
  return {hn::Xor(a.v, sign)};
}
HWY_INLINE HWY_ATTR Dual with_sign_of(Dual a, FloatVec sign) {
  return {hn::Xor(a.v, sign), hn::Xor(a.x, sign), hn::Xor(a.y, sign), hn::Xor(a.z, sign)};
}

/// Into the cell around the nearest multiple of the period, between the first and the last. With
/// alternation every second cell is a mirror image, which leaves no step at the walls.
struct RepeatWarp {
  struct Axis {
    FloatVec offset, period, inverse, first, last;
    bool repeats;
    HWY_ATTR explicit Axis(const float* k)
        : offset(set(k[0])),
          period(set(k[3])),
          inverse(set(k[6])),
          first(set(k[9])),
          last(set(k[12])),
          repeats(k[3] > 0.0F) {}
  };
  Axis x, y, z;
  bool alternates;
  HWY_ATTR explicit RepeatWarp(const float* k)
      : x(k), y(k + 1), z(k + 2), alternates(k[15] > 0.5F) {}
  template <class N>
  HWY_INLINE HWY_ATTR N folded(N at, const Axis& axis) const {
    at = sub(at, axis.offset);
    if (!axis.repeats) return at;
    auto cell = hn::Round(hn::Mul(at.v, axis.inverse));
    cell = hn::Min(hn::Max(cell, axis.first), axis.last);
    at = sub(at, hn::Mul(cell, axis.period));
    if (!alternates) return at;
    const auto sign = hn::ShiftLeft<31>(hn::NearestInt(cell));
    return with_sign_of(at, hn::BitCast(Floats(), sign));
  }
  template <class N>
  HWY_INLINE HWY_ATTR Point<N> operator()(const Point<N>& p) const {
    return {folded(p.x, x), folded(p.y, y), folded(p.z, z)};
  }
};

struct MirrorWarp {
  Triple c;
  FloatMask x, y, z;
  HWY_ATTR explicit MirrorWarp(const float* k)
      : c(triple(k)),
        x(hn::Gt(set(k[3]), set(0.5F))),
        y(hn::Gt(set(k[4]), set(0.5F))),
        z(hn::Gt(set(k[5]), set(0.5F))) {}
  template <class N>
  HWY_INLINE HWY_ATTR Point<N> operator()(const Point<N>& at) const {
    const Point<N> p = sub(at, c);
    return {choose(x, absolute(p.x), p.x), choose(y, absolute(p.y), p.y),
            choose(z, absolute(p.z), p.z)};
  }
};

/// Takes (u, v) to the circle of the given radius if it lies outside, then turns it by `angle`.
template <class N>
HWY_INLINE HWY_ATTR void turn_within(N& u, N& v, N angle_per_radian, FloatVec radius) {
  const N r = length(u, v);
  const auto outside = hn::Gt(r.v, radius);
  const N shrink = choose(outside, inverse_of(r, radius), constant(r, set(1.0F)));
  const N a = mul(u, shrink), b = mul(v, shrink);
  const N c = cosine(angle_per_radian), s = sine(angle_per_radian);
  u = sub(mul(c, a), mul(s, b));
  v = add(mul(s, a), mul(c, b));
}
/// radius / r
HWY_INLINE HWY_ATTR Real inverse_of(Real r, FloatVec radius) {
  return {hn::Div(radius, r.v)};
}
HWY_INLINE HWY_ATTR Dual inverse_of(Dual r, FloatVec radius) {
  const auto value = hn::Div(radius, r.v);
  return chained(value, hn::Neg(hn::Div(value, r.v)), r);
}

struct TwistWarp {
  Triple c;
  FloatVec rate, radius;
  HWY_ATTR explicit TwistWarp(const float* k) : c(triple(k)), rate(set(k[3])), radius(set(k[4])) {}
  template <class N>
  HWY_INLINE HWY_ATTR Point<N> operator()(const Point<N>& at) const {
    Point<N> p = sub(at, c);
    turn_within(p.x, p.z, mul(p.y, rate), radius);
    return p;
  }
};

/// Turns about z by an angle that grows with x.
struct BendWarp {
  Triple c;
  FloatVec rate, radius;
  HWY_ATTR explicit BendWarp(const float* k) : c(triple(k)), rate(set(k[3])), radius(set(k[4])) {}
  template <class N>
  HWY_INLINE HWY_ATTR Point<N> operator()(const Point<N>& at) const {
    Point<N> p = sub(at, c);
    // The angle is that of the point taken to the circle, so that the whole is projected first.
    const N r = length(p.x, p.y);
    const auto outside = hn::Gt(r.v, radius);
    const N shrink = choose(outside, inverse_of(r, radius), constant(r, set(1.0F)));
    turn_within(p.x, p.y, mul(mul(p.x, shrink), rate), radius);
    return p;
  }
};

/// x becomes the distance from the line along y through (k0, ., k1).
struct RevolveWarp {
  FloatVec x, z;
  HWY_ATTR explicit RevolveWarp(const float* k) : x(set(k[0])), z(set(k[1])) {}
  template <class N>
  HWY_INLINE HWY_ATTR Point<N> operator()(const Point<N>& p) const {
    return {long_length(sub(p.x, x), sub(p.z, z)), p.y, constant(p.y, hn::Zero(Floats()))};
  }
};

// ---- distances from distances ----

/// Quadratic blend over the width k (Quilez): never above the lesser, the lesser itself where the
/// two differ by k or more.
template <class N>
HWY_INLINE HWY_ATTR N smooth_lesser(N a, N b, FloatVec inverse_k, FloatVec quarter_k) {
  const N apart = absolute(sub(a, b));
  const N h = greater(sub(constant(a, set(1.0F)), mul(apart, inverse_k)), hn::Zero(Floats()));
  return sub(lesser(a, b), mul(mul(h, h), quarter_k));
}

struct WavesWarp {
  Triple c, k3;
  FloatVec amplitude, inverse_lambda;
  HWY_ATTR explicit WavesWarp(const float* k)
      : c(triple(k)), k3(triple(k + 3)), amplitude(set(k[6])), inverse_lambda(set(k[7])) {}
  template <class N>
  HWY_INLINE HWY_ATTR N operator()(N distance, const Point<N>& at) const {
    const Point<N> p = sub(at, c);
    const N product = mul(mul(sine(mul(p.x, k3.x)), sine(mul(p.y, k3.y))), sine(mul(p.z, k3.z)));
    return mul(add(distance, mul(product, amplitude)), inverse_lambda);
  }
};

// A repeated cell's guard (compile.cpp): half extents of the content along repeated axes, walls,
// half gaps, and half extents along the other axes.
struct RepeatGuardWarp {
  Triple half, wall, apart, other;
  HWY_ATTR explicit RepeatGuardWarp(const float* k)
      : half(triple(k)), wall(triple(k + 3)), apart(triple(k + 6)), other(triple(k + 9)) {}
  template <class N>
  HWY_INLINE HWY_ATTR N operator()(N distance, const Point<N>& p) const {
    const N x = absolute(p.x), y = absolute(p.y), z = absolute(p.z);
    const N aside = greater(sub(x, other.x), greater(sub(y, other.y), sub(z, other.z)));
    const N outside = greater(sub(x, half.x), greater(sub(y, half.y), sub(z, half.z)));
    const N to_x = add(absolute(sub(x, wall.x)), apart.x),
            to_y = add(absolute(sub(y, wall.y)), apart.y),
            to_z = add(absolute(sub(z, wall.z)), apart.z);
    const N neighbour = greater(lesser(to_x, lesser(to_y, to_z)), aside);
    return lesser(greater(distance, greater(outside, aside)), neighbour);
  }
};

struct RadiusGuardWarp {
  Triple c;
  FloatVec inverse_lambda, radius;
  FloatMask about_y;
  HWY_ATTR explicit RadiusGuardWarp(const float* k)
      : c(triple(k)),
        inverse_lambda(set(k[3])),
        radius(set(k[4])),
        about_y(hn::Gt(set(k[5]), set(0.5F))) {}
  template <class N>
  HWY_INLINE HWY_ATTR N operator()(N distance, const Point<N>& at) const {
    const Point<N> p = sub(at, c);
    const N r = length(p.x, choose(about_y, p.z, p.y));
    return greater(mul(distance, inverse_lambda), sub(r, radius));
  }
};

// ---- value noise ----

/// Uniform in [-1, 1], a hash of a lattice corner (xor-multiply rounds, after Wang).
HWY_INLINE HWY_ATTR FloatVec lattice_value(WordVec x, WordVec y, WordVec z) {
  const Words dw;
  auto h = hn::Xor(hn::Xor(x, y), z);
  h = hn::Mul(hn::Xor(h, hn::ShiftRight<15>(h)), hn::Set(dw, 0x2C1B3C6DU));
  h = hn::Mul(hn::Xor(h, hn::ShiftRight<12>(h)), hn::Set(dw, 0x297A2D39U));
  const auto mantissa = hn::ShiftRight<8>(hn::Xor(h, hn::ShiftRight<15>(h)));
  const auto unit = hn::ConvertTo(Floats(), hn::BitCast(Ints(), mantissa));
  return hn::MulAdd(unit, set(0x1p-23F), set(-1.0F));
}

/// One axis of a lattice cell: hashes of both corners, the faded coordinate and its slope.
struct LatticeAxis {
  WordVec low, high;
  FloatVec fade, slope;
};
HWY_INLINE HWY_ATTR LatticeAxis lattice_axis(FloatVec x, std::uint32_t salt) {
  const Words dw;
  const auto floor = hn::Floor(x), t = hn::Sub(x, floor);
  const auto low = hn::BitCast(dw, hn::NearestInt(floor));
  const auto factor = hn::Set(dw, salt);
  const auto one = set(1.0F), three = set(3.0F), two = set(2.0F);
  return {hn::Mul(low, factor), hn::Mul(hn::Add(low, hn::Set(dw, 1U)), factor),
          hn::Mul(hn::Mul(t, t), hn::NegMulAdd(two, t, three)),
          hn::Mul(hn::Mul(set(6.0F), t), hn::Sub(one, t))};
}
HWY_INLINE HWY_ATTR FloatVec mix(FloatVec a, FloatVec b, FloatVec t) {
  return hn::MulAdd(t, hn::Sub(b, a), a);
}

/// Value noise in [-1, 1] with the fade 3 t^2 - 2 t^3, and its gradient where N carries one.
struct LatticeNoise {
  FloatVec v[8];
  LatticeAxis x, y, z;
  HWY_INLINE HWY_ATTR LatticeNoise(FloatVec px, FloatVec py, FloatVec pz, std::uint32_t seed)
      : x(lattice_axis(px, 0x9E3779B1U)),
        y(lattice_axis(py, 0x85EBCA77U)),
        z(lattice_axis(pz, 0xC2B2AE3DU)) {
    const auto salt = hn::Set(Words(), seed * 0x27D4EB2FU);
    const auto x0 = hn::Xor(x.low, salt), x1 = hn::Xor(x.high, salt);
    v[0] = lattice_value(x0, y.low, z.low), v[1] = lattice_value(x1, y.low, z.low);
    v[2] = lattice_value(x0, y.high, z.low), v[3] = lattice_value(x1, y.high, z.low);
    v[4] = lattice_value(x0, y.low, z.high), v[5] = lattice_value(x1, y.low, z.high);
    v[6] = lattice_value(x0, y.high, z.high), v[7] = lattice_value(x1, y.high, z.high);
  }
  HWY_INLINE HWY_ATTR FloatVec value() const {
    return mix(mix(mix(v[0], v[1], x.fade), mix(v[2], v[3], x.fade), y.fade),
               mix(mix(v[4], v[5], x.fade), mix(v[6], v[7], x.fade), y.fade), z.fade);
  }
  HWY_INLINE HWY_ATTR Real number(const Point<Real>&) const { return {value()}; }
  HWY_INLINE HWY_ATTR Dual number(const Point<Dual>& p) const {
    const auto along_x = mix(mix(hn::Sub(v[1], v[0]), hn::Sub(v[3], v[2]), y.fade),
                             mix(hn::Sub(v[5], v[4]), hn::Sub(v[7], v[6]), y.fade), z.fade);
    const auto along_y = mix(mix(hn::Sub(v[2], v[0]), hn::Sub(v[3], v[1]), x.fade),
                             mix(hn::Sub(v[6], v[4]), hn::Sub(v[7], v[5]), x.fade), z.fade);
    const auto along_z = mix(mix(hn::Sub(v[4], v[0]), hn::Sub(v[5], v[1]), x.fade),
                             mix(hn::Sub(v[6], v[2]), hn::Sub(v[7], v[3]), x.fade), y.fade);
    const Dual xy =
        chained(value(), hn::Mul(along_x, x.slope), p.x, hn::Mul(along_y, y.slope), p.y);
    const Dual zz = chained(xy.v, hn::Mul(along_z, z.slope), p.z);
    return {xy.v, hn::Add(xy.x, zz.x), hn::Add(xy.y, zz.y), hn::Add(xy.z, zz.z)};
  }
};

struct NoiseWarp {
  const float* k;
  HWY_ATTR explicit NoiseWarp(const float* constants) : k(constants) {}
  template <class N>
  HWY_INLINE HWY_ATTR N operator()(N distance, const Point<N>& at) const {
    Point<N> p = sub(at, triple(k));
    p = {mul(p.x, set(k[3])), mul(p.y, set(k[3])), mul(p.z, set(k[3]))};
    const int octaves = static_cast<int>(k[5]);
    float amplitude = k[4];
    for (int octave = 0; octave < octaves; ++octave, amplitude *= k[6]) {
      const auto seed = static_cast<std::uint32_t>(k[7]) * 8U + static_cast<std::uint32_t>(octave);
      const LatticeNoise noise(p.x.v, p.y.v, p.z.v, seed);
      distance = add(distance, mul(noise.number(p), set(amplitude)));
      p = {add(p.x, p.x), add(p.y, p.y), add(p.z, p.z)};
    }
    return mul(distance, set(k[8]));
  }
};

}  // namespace macula::sdf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
