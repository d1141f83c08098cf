// Places between the nodes of the lobe's albedo table (ggx_albedo.h) in every lane, for this room's
// *_simd.cpp: to be included below hwy/highway.h, once for every target.
#if defined(MACULA_SHADING_GGX_NODES_SIMD_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MACULA_SHADING_GGX_NODES_SIMD_H
#undef MACULA_SHADING_GGX_NODES_SIMD_H
#else
#define MACULA_SHADING_GGX_NODES_SIMD_H
#endif

#include "hwy/highway.h"
#include "server/sampling/vectors_simd.h"
#include "server/shading/ggx_albedo.h"

HWY_BEFORE_NAMESPACE();
namespace macula::shading::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using namespace sampling::HWY_NAMESPACE;

/// Node below a value in [0, 1] and the way from there to the next.
struct Place {
  IntVec node;
  FloatVec blend;
};
HWY_INLINE HWY_ATTR Place locate(FloatVec value) {
  const Floats d;
  const Ints di;
  constexpr float kSteps = GgxAlbedoNodes::kNodes - 1;
  const auto t = hn::Mul(hn::Sqrt(value), hn::Set(d, kSteps));
  const auto node =
      hn::Min(hn::Max(hn::ConvertTo(di, t), hn::Zero(di)), hn::Set(di, GgxAlbedoNodes::kNodes - 2));
  const auto n = hn::ConvertTo(d, node);
  // Nodes stand for squares: (n + 1)^2 - n^2 = 2 n + 1 steps^2 between neighbours.
  const auto above = hn::NegMulAdd(n, n, hn::Mul(value, hn::Set(d, kSteps * kSteps)));
  const auto blend = hn::Div(above, hn::MulAdd(hn::Set(d, 2.0F), n, hn::Set(d, 1.0F)));
  return {node, hn::Min(hn::Max(blend, hn::Zero(d)), hn::Set(d, 1.0F))};
}

struct Albedo {
  FloatVec a, b;
};
HWY_INLINE HWY_ATTR Albedo mix(const Albedo& x, const Albedo& y, FloatVec t) {
  return {hn::MulAdd(t, hn::Sub(y.a, x.a), x.a), hn::MulAdd(t, hn::Sub(y.b, x.b), x.b)};
}

}  // namespace macula::shading::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // one target's copy
