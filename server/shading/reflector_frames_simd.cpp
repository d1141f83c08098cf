// Reflectors from BSDFs and normals in vectors; Reflector's constructor and make_shading_frame are
// their oracles.
#include "server/shading/bsdf_batch.h"
#include "server/shading/ggx.h"
#include "server/shading/ggx_albedo.h"
#include "server/shading/reflector_batch.h"
#include "server/shading/surface_batch.h"
#include "shared/base/check.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/shading/reflector_frames_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"
#include "server/sampling/vectors_simd.h"
#include "server/shading/ggx_nodes_simd.h"

#ifndef MACULA_SHADING_LEAST_COSINE
#define MACULA_SHADING_LEAST_COSINE
namespace macula::shading {
/// Of bsdf.cpp's frames: between shading normal and eye after bending.
inline constexpr float kLeastBentCosine = 1e-3F;
}  // namespace macula::shading
#endif

HWY_BEFORE_NAMESPACE();
namespace macula::shading::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using namespace sampling::HWY_NAMESPACE;

// ---- frames ----

/// v or -v, whichever has a cosine to `towards` that is not negative.
HWY_INLINE HWY_ATTR Vec3s turned(const Vec3s& v, const Vec3s& towards) {
  const auto away = hn::Lt(dot(v, towards), hn::Zero(Floats()));
  return {hn::IfThenElse(away, hn::Neg(v.x), v.x), hn::IfThenElse(away, hn::Neg(v.y), v.y),
          hn::IfThenElse(away, hn::Neg(v.z), v.z)};
}
/// Bent towards the eye until it lies above the horizon.
HWY_INLINE HWY_ATTR Vec3s bent(const Vec3s& shading, const Vec3s& to_eye) {
  const Floats d;
  const auto least = hn::Set(d, kLeastBentCosine);
  const auto cosine = dot(shading, to_eye);
  const auto below = hn::Lt(cosine, least);
  const Vec3s sum = plus(shading, hn::Sub(least, cosine), to_eye);
  const Vec3s lifted = scaled(hn::Div(hn::Set(d, 1.0F), hn::Sqrt(dot(sum, sum))), sum);
  return {hn::IfThenElse(below, lifted.x, shading.x), hn::IfThenElse(below, lifted.y, shading.y),
          hn::IfThenElse(below, lifted.z, shading.z)};
}

// ---- the lobe's albedo ----

HWY_INLINE HWY_ATTR Albedo node(const float* table, IntVec index) {
  const Floats d;
  const auto at = hn::Add(index, index);
  return {hn::GatherIndex(d, table, at), hn::GatherIndex(d, table + 1, at)};
}
HWY_INLINE HWY_ATTR Albedo directional(const float* table, const Place& x, const Place& y) {
  const Ints di;
  const auto one = hn::Set(di, 1), next_row = hn::Set(di, GgxAlbedoNodes::kNodes);
  const auto corner = hn::Add(hn::Mul(y.node, next_row), x.node), below = hn::Add(corner, next_row);
  return mix(mix(node(table, corner), node(table, hn::Add(corner, one)), x.blend),
             mix(node(table, below), node(table, hn::Add(below, one)), x.blend), y.blend);
}

// ---- reflectors ----

/// One channel of what does not depend on the light: the diffuse term, and all that is reflected.
struct Channel {
  FloatVec diffuse, reflectance;
};
HWY_INLINE HWY_ATTR Channel channel(FloatVec albedo, FloatVec f0, FloatVec f90, const Albedo& seen,
                                    const Albedo& mean) {
  const Floats d;
  const auto one = hn::Set(d, 1.0F);
  const auto lobe = hn::MulAdd(f0, seen.a, hn::Mul(f90, seen.b));
  const auto average = hn::MulAdd(f0, mean.a, hn::Mul(f90, mean.b));
  const auto passed = hn::Mul(albedo, hn::Sub(one, lobe));
  const auto left = hn::Max(hn::Sub(one, average), hn::Set(d, 1e-4F));  // as Reflector's
  return {hn::Div(passed, hn::Mul(hn::Set(d, kPi), left)), hn::Add(lobe, passed)};
}

/// With Phong's lobe, as Reflector has it.
HWY_INLINE HWY_ATTR Channel phong_channel(FloatVec albedo, FloatVec f0) {
  const Floats d;
  const auto passed = hn::Mul(albedo, hn::Sub(hn::Set(d, 1.0F), f0));
  return {hn::Mul(hn::Set(d, 1.0F / kPi), passed), hn::Add(f0, passed)};
}
/// Without a Fresnel term nothing here depends on the eye.
HWY_ATTR void phong_vectors(const BsdfBatch& bsdfs, std::size_t count, ReflectorBatch& out) {
  const Floats d;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const Vec3s albedo = load(bsdfs.albedo, i), f0 = load(bsdfs.f0, i);
    const Channel r = phong_channel(albedo.x, f0.x), g = phong_channel(albedo.y, f0.y);
    const Channel b = phong_channel(albedo.z, f0.z);
    store({r.diffuse, g.diffuse, b.diffuse}, out.diffuse, i);
    store({r.reflectance, g.reflectance, b.reflectance}, out.reflectance, i);
  }
}

HWY_ATTR void reflector_vectors(const BsdfBatch& bsdfs, const SurfaceBatch& surfaces,
                                const sampling::Vec3Batch& to_eyes, std::size_t count,
                                ReflectorBatch& out) {
  const Floats d;
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.0F);
  const float *table = GgxAlbedoNodes::directional(), *means = GgxAlbedoNodes::mean();
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const Vec3s to_eye = load(to_eyes, i);
    const Vec3s geometric = turned(load(surfaces.geometric, i), to_eye);
    const Vec3s shading = bent(turned(load(surfaces.shading, i), geometric), to_eye);
    store(to_eye, out.to_eye, i);
    store(geometric, out.geometric, i);
    store(shading, out.shading, i);
    const auto cos_v = hn::Min(hn::Max(dot(shading, to_eye), hn::Set(d, kLeastBentCosine)), one);
    hn::Store(cos_v, d, out.cos_v.at + i);
    const Vec3s albedo = load(bsdfs.albedo, i), f0 = load(bsdfs.f0, i);
    const auto f90 = hn::Load(d, bsdfs.f90.at + i), alpha = hn::Load(d, bsdfs.alpha.at + i);
    const auto glossy = hn::Gt(hn::Max(hn::Max(f90, f0.x), hn::Max(f0.y, f0.z)), zero);
    const Place width = locate(alpha);
    const Albedo seen = directional(table, locate(cos_v), width);
    const Albedo mean = mix(node(means, width.node),
                            node(means, hn::Add(width.node, hn::Set(Ints(), 1))), width.blend);
    const Channel r = channel(albedo.x, f0.x, f90, seen, mean);
    const Channel g = channel(albedo.y, f0.y, f90, seen, mean);
    const Channel b = channel(albedo.z, f0.z, f90, seen, mean);
    const Vec3s plain = scaled(hn::Set(d, 1.0F / kPi), albedo);
    store({hn::IfThenElse(glossy, r.diffuse, plain.x), hn::IfThenElse(glossy, g.diffuse, plain.y),
           hn::IfThenElse(glossy, b.diffuse, plain.z)},
          out.diffuse, i);
    store({hn::IfThenElse(glossy, r.reflectance, albedo.x),
           hn::IfThenElse(glossy, g.reflectance, albedo.y),
           hn::IfThenElse(glossy, b.reflectance, albedo.z)},
          out.reflectance, i);
    store(f0, out.f0, i);
    hn::Store(f90, d, out.f90.at + i);
    hn::Store(hn::IfThenElseZero(glossy, alpha), d, out.alpha.at + i);
  }
}

}  // namespace macula::shading::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::shading {

HWY_EXPORT(reflector_vectors);
HWY_EXPORT(phong_vectors);

void make_reflectors(const BsdfBatch& bsdfs, const SurfaceBatch& surfaces,
                     const sampling::Vec3Batch& to_eye, std::size_t count, ReflectorBatch& out) {
  MACULA_DCHECK(count <= sampling::kBatch);
  HWY_DYNAMIC_DISPATCH(reflector_vectors)(bsdfs, surfaces, to_eye, count, out);
  out.lobe = bsdfs.lobe;
  if (bsdfs.lobe == LobeModel::Phong) HWY_DYNAMIC_DISPATCH(phong_vectors)(bsdfs, count, out);
}

}  // namespace macula::shading
#endif
