// The primitives, each a signed distance or a 1-Lipschitz bound of it, y up. Each takes its
// constants in the order compile.cpp writes them. Formulas after Quilez' catalogue of distance
// functions; ellipsoid and octahedron are bounds. Included once per SIMD target.
#if defined(MACULA_SDF_PRIMITIVES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MACULA_SDF_PRIMITIVES_INL_H
#undef MACULA_SDF_PRIMITIVES_INL_H
#else
#define MACULA_SDF_PRIMITIVES_INL_H
#endif

#include "server/sdf/numbers-inl.h"

HWY_BEFORE_NAMESPACE();
namespace macula::sdf::HWY_NAMESPACE {

struct SphereShape {
  Triple c;
  FloatVec radius;
  HWY_ATTR explicit SphereShape(const float* k) : c(triple(k)), radius(set(k[3])) {}
  template <class N>
  HWY_INLINE HWY_ATTR N operator()(const Point<N>& at) const {
    const Point<N> p = sub(at, c);
    return sub(long_length(p.x, p.y, p.z), radius);
  }
};

struct BoxShape {
  Triple c, half;
  FloatVec edge;
  HWY_ATTR explicit BoxShape(const float* k) : c(triple(k)), half(triple(k + 3)), edge(set(k[6])) {}
  template <class N>
  HWY_INLINE HWY_ATTR N operator()(const Point<N>& at) const {
    const Point<N> p = sub(at, c);
    const N x = sub(absolute(p.x), half.x), y = sub(absolute(p.y), half.y),
            z = sub(absolute(p.z), half.z);
    const auto zero = hn::Zero(Floats());
    const N outside = length(greater(x, zero), greater(y, zero), greater(z, zero));
    const N inside = lesser(greater(x, greater(y, z)), zero);
    return sub(add(outside, inside), edge);
  }
};

// Tori, cylinders and cones take points that Op::Revolve made: x is the distance from their axis.

struct TorusShape {
  FloatVec y, radius, tube;
  HWY_ATTR explicit TorusShape(const float* k) : y(set(k[0])), radius(set(k[1])), tube(set(k[2])) {}
  template <class N>
  HWY_INLINE HWY_ATTR N operator()(const Point<N>& p) const {
    return sub(long_length(sub(p.x, radius), sub(p.y, y)), tube);
  }
};

/// The distance to what lies at x <= 0 and y <= 0, which both are distances at right angles.
template <class N>
HWY_INLINE HWY_ATTR N corner(N x, N y) {
  const auto zero = hn::Zero(Floats());
  return add(length(greater(x, zero), greater(y, zero)), lesser(greater(x, y), zero));
}

struct CylinderShape {
  FloatVec y, radius, half, edge;
  HWY_ATTR explicit CylinderShape(const float* k)
      : y(set(k[0])), radius(set(k[1])), half(set(k[2])), edge(set(k[3])) {}
  template <class N>
  HWY_INLINE HWY_ATTR N operator()(const Point<N>& p) const {
    return sub(corner(sub(p.x, radius), sub(absolute(sub(p.y, y)), half)), edge);
  }
};

struct ConeShape {
  FloatVec y, bottom, top, half, side, height, inverse;
  HWY_ATTR explicit ConeShape(const float* k)
      : y(set(k[0])),
        bottom(set(k[1])),
        top(set(k[2])),
        half(set(k[3])),
        side(set(k[4])),
        height(set(k[5])),
        inverse(set(k[6])) {}
  template <class N>
  HWY_INLINE HWY_ATTR N operator()(const Point<N>& p) const {
    const auto zero = hn::Zero(Floats());
    const N q = p.x, up = sub(p.y, y);
    // To the discs at both ends, and to the slanted side between (bottom, -half) and (top, half).
    const auto rim = hn::IfThenElse(hn::Lt(up.v, zero), bottom, top);
    const N cap_x = greater(sub(q, rim), zero), cap_y = sub(absolute(up), half);
    const N from_x = sub(q, bottom), from_y = add(up, half);
    N share = mul(add(mul(from_x, side), mul(from_y, height)), inverse);
    share = lesser(greater(share, zero), set(1.0F));
    const N side_x = sub(from_x, mul(share, side)), side_y = sub(from_y, mul(share, height));
    const N nearest = lesser_length(cap_x, cap_y, side_x, side_y);
    const auto inside = hn::And(hn::Lt(side_x.v, zero), hn::Lt(cap_y.v, zero));
    return choose(inside, negate(nearest), nearest);
  }
};

struct CapsuleShape {
  Triple from, axis;
  FloatVec inverse, radius;
  HWY_ATTR explicit CapsuleShape(const float* k)
      : from(triple(k)), axis(triple(k + 3)), inverse(set(k[6])), radius(set(k[7])) {}
  template <class N>
  HWY_INLINE HWY_ATTR N operator()(const Point<N>& at) const {
    const Point<N> p = sub(at, from);
    N share = mul_add(p.x, axis.x, mul_add(p.y, axis.y, mul(p.z, axis.z)));
    share = lesser(greater(mul(share, inverse), hn::Zero(Floats())), set(1.0F));
    return sub(length(sub(p.x, mul(share, axis.x)), sub(p.y, mul(share, axis.y)),
                      sub(p.z, mul(share, axis.z))),
               radius);
  }
};

struct PlaneShape {
  Triple normal;
  FloatVec offset;
  HWY_ATTR explicit PlaneShape(const float* k) : normal(triple(k)), offset(set(k[3])) {}
  template <class N>
  HWY_INLINE HWY_ATTR N operator()(const Point<N>& p) const {
    return mul_add(p.x, normal.x, mul_add(p.y, normal.y, add(mul(p.z, normal.z), offset)));
  }
};

/// (|p / radii| - 1) times the smallest radius: the largest 1-Lipschitz multiple of that form.
struct EllipsoidShape {
  Triple c, inverse;
  FloatVec smallest;
  HWY_ATTR explicit EllipsoidShape(const float* k)
      : c(triple(k)), inverse(triple(k + 3)), smallest(set(k[6])) {}
  template <class N>
  HWY_INLINE HWY_ATTR N operator()(const Point<N>& at) const {
    const Point<N> p = sub(at, c);
    const N ratio = length(mul(p.x, inverse.x), mul(p.y, inverse.y), mul(p.z, inverse.z));
    return mul(sub(ratio, set(1.0F)), smallest);
  }
};

/// The distance to the nearest face's plane.
struct OctahedronShape {
  Triple c;
  FloatVec radius;
  HWY_ATTR explicit OctahedronShape(const float* k) : c(triple(k)), radius(set(k[3])) {}
  template <class N>
  HWY_INLINE HWY_ATTR N operator()(const Point<N>& at) const {
    const Point<N> p = sub(at, c);
    const N sum = add(absolute(p.x), add(absolute(p.y), absolute(p.z)));
    return mul(sub(sum, radius), set(0.57735027F));
  }
};

/// Flat sides face z and +-60 degrees from it; `radius` is the inscribed circle's.
struct HexPrismShape {
  Triple c;
  FloatVec radius, half;
  HWY_ATTR explicit HexPrismShape(const float* k)
      : c(triple(k)), radius(set(k[3])), half(set(k[4])) {}
  template <class N>
  HWY_INLINE HWY_ATTR N operator()(const Point<N>& at) const {
    const Point<N> p = sub(at, c);
    const auto zero = hn::Zero(Floats());
    N x = absolute(p.x), z = absolute(p.z);
    // Folds the plane onto the sixth around z, then measures to that side's segment.
    const N beyond = lesser(add(mul(x, set(-0.8660254F)), mul(z, set(0.5F))), zero);
    x = add(x, mul(beyond, set(1.7320508F)));
    z = sub(z, beyond);
    const auto reach = hn::Mul(radius, set(0.57735027F));
    const N along = sub(x, lesser(greater(x, hn::Neg(reach)), reach));
    const N across = sub(z, radius);
    const N flat = length(along, across);
    const N ring = choose(hn::Lt(across.v, zero), negate(flat), flat);
    return corner(ring, sub(absolute(p.y), half));
  }
};

}  // namespace macula::sdf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
