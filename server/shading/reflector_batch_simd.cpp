#include "server/shading/ggx.h"
#include "server/shading/ggx_albedo.h"
#include "server/shading/reflector_batch.h"
#include "shared/base/check.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/shading/reflector_batch_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

#include "hwy/contrib/math/math-inl.h"
#include "server/sampling/vectors_simd.h"
#include "server/shading/ggx_nodes_simd.h"

HWY_BEFORE_NAMESPACE();
namespace macula::shading::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using namespace sampling::HWY_NAMESPACE;

// ---- the lobe's directional albedo, from its table ----

/// In units of 1/65535.
HWY_INLINE HWY_ATTR Albedo gather(IntVec index) {
  const Floats d;
  const Ints di;
  const auto packed = hn::GatherIndex(di, GgxAlbedoNodes::packed(), index);
  const auto upper = hn::ShiftRight<16>(hn::BitCast(Words(), packed));
  return {hn::ConvertTo(d, hn::And(packed, hn::Set(di, 0xFFFF))),
          hn::ConvertTo(d, hn::BitCast(di, upper))};
}
HWY_INLINE HWY_ATTR Albedo albedo(FloatVec mu, FloatVec alpha) {
  const Floats d;
  const Ints di;
  const Place x = locate(mu), y = locate(alpha);
  const auto corner = hn::Add(hn::ShiftLeft<5>(y.node), x.node);
  static_assert(GgxAlbedoNodes::kNodes == 1 << 5);
  const auto right = hn::Set(di, 1), next_row = hn::Set(di, GgxAlbedoNodes::kNodes);
  const auto below = hn::Add(corner, next_row);
  const Albedo mixed = mix(mix(gather(corner), gather(hn::Add(corner, right)), x.blend),
                           mix(gather(below), gather(hn::Add(below, right)), x.blend), y.blend);
  const auto unit = hn::Set(d, 1.0F / 65535.0F);
  return {hn::Mul(unit, mixed.a), hn::Mul(unit, mixed.b)};
}

// ---- the BSDF ----

/// The light's cosine times D G / (4 cos_v cos_l), and Schlick's weight of f90.
struct Lobe {
  FloatVec strength, grazing;
};
HWY_INLINE HWY_ATTR Lobe lobe(const ReflectorBatch& r, std::size_t i, const Vec3s& to_light,
                              FloatVec cos_l, FloatVec alpha) {
  const Floats d;
  const auto one = hn::Set(d, 1.0F), zero = hn::Zero(d);
  const Vec3s eye = load(r.to_eye, i);
  const Vec3s sum = plus(eye, to_light);
  const auto inverse = hn::Div(one, hn::Sqrt(dot(sum, sum)));
  const auto cos_half = hn::Mul(dot(load(r.shading, i), sum), inverse);
  const auto cos_vh = hn::Mul(dot(eye, sum), inverse);
  const auto a2 = hn::Mul(alpha, alpha), rest = hn::Sub(one, a2);
  const auto beside = hn::Mul(hn::Sub(one, cos_half), hn::Add(one, cos_half));
  const auto width = hn::MulAdd(hn::Mul(cos_half, cos_half), a2, beside);
  const auto cos_v = hn::Load(d, r.cos_v.at + i);
  const auto view = hn::Sqrt(hn::MulAdd(hn::Mul(cos_v, cos_v), rest, a2));
  const auto light = hn::Sqrt(hn::MulAdd(hn::Mul(cos_l, cos_l), rest, a2));
  const auto masking = hn::MulAdd(cos_l, view, hn::Mul(cos_v, light));
  const auto under = hn::Mul(hn::Mul(hn::Set(d, kPi), hn::Mul(width, width)), masking);
  const auto over = hn::Mul(hn::Set(d, 0.5F), hn::Mul(a2, cos_l));
  const auto m = hn::Min(hn::Max(hn::Sub(one, cos_vh), zero), one), m2 = hn::Mul(m, m);
  return {hn::IfThenElseZero(hn::Gt(cos_half, zero), hn::Div(over, under)),
          hn::Mul(m, hn::Mul(m2, m2))};
}

/// f0 + (f90 - f0) grazing, times the lobe; plus what the lobe leaves to the diffuse part.
HWY_INLINE HWY_ATTR FloatVec channel(FloatVec f0, FloatVec f90, FloatVec diffuse, const Lobe& lobe,
                                     const Albedo& taken) {
  const auto fresnel = hn::MulAdd(hn::Sub(f90, f0), lobe.grazing, f0);
  const auto share = hn::MulAdd(f0, taken.a, hn::Mul(f90, taken.b));
  return hn::MulAdd(lobe.strength, fresnel, hn::NegMulAdd(diffuse, share, diffuse));
}

HWY_INLINE HWY_ATTR Vec3s under_lobe(const ReflectorBatch& r, std::size_t i, const Vec3s& to_light,
                                     FloatVec cos_l, FloatVec alpha, const Vec3s& diffuse) {
  const Floats d;
  const auto cos_clamped = hn::Min(hn::Max(cos_l, hn::Zero(d)), hn::Set(d, 1.0F));
  const Lobe glare = lobe(r, i, to_light, cos_clamped, alpha);
  const Albedo taken = albedo(cos_clamped, alpha);
  const Vec3s f0 = load(r.f0, i);
  const auto f90 = hn::Load(d, r.f90.at + i);
  const auto has_lobe = hn::Gt(alpha, hn::Zero(d));
  const Vec3s under = scaled(cos_l, diffuse);
  return {hn::IfThenElse(has_lobe, channel(f0.x, f90, under.x, glare, taken), under.x),
          hn::IfThenElse(has_lobe, channel(f0.y, f90, under.y, glare, taken), under.y),
          hn::IfThenElse(has_lobe, channel(f0.z, f90, under.z, glare, taken), under.z)};
}

/// The same under Phong's lobe (phong.h).
HWY_INLINE HWY_ATTR Vec3s under_phong(const ReflectorBatch& r, std::size_t i, const Vec3s& to_light,
                                      FloatVec cos_l, FloatVec alpha, const Vec3s& diffuse) {
  const Floats d;
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.0F), two = hn::Set(d, 2.0F);
  const Vec3s eye = load(r.to_eye, i), normal = load(r.shading, i);
  const auto twice = hn::Mul(two, dot(normal, eye));
  const Vec3s mirror{hn::MulSub(twice, normal.x, eye.x), hn::MulSub(twice, normal.y, eye.y),
                     hn::MulSub(twice, normal.z, eye.z)};
  const Vec3s difference{hn::Sub(mirror.x, to_light.x), hn::Sub(mirror.y, to_light.y),
                         hn::Sub(mirror.z, to_light.z)};
  const auto below_one = hn::Mul(hn::Set(d, 0.5F), dot(difference, difference));
  const auto reached = hn::And(hn::Lt(below_one, one), hn::Gt(alpha, zero));
  const auto exponent = hn::Sub(hn::Div(two, hn::Mul(alpha, alpha)), two);
  const auto log = hn::Log1p(d, hn::IfThenElseZero(reached, hn::Neg(below_one)));
  // Below -87 a float's exp is 0 and its vectors' is not defined.
  const auto power = hn::Exp(d, hn::Max(hn::Mul(exponent, log), hn::Set(d, -87.0F)));
  const auto scale = hn::Mul(hn::Add(exponent, two), hn::Set(d, 0.5F / kPi));
  const auto lobe = hn::IfThenElseZero(reached, hn::Mul(hn::Mul(scale, power), cos_l));
  return plus(scaled(cos_l, diffuse), lobe, load(r.f0, i));
}

HWY_ATTR void reflect_vectors(const ReflectorBatch& r, const sampling::Vec3Batch& to_lights,
                              const sampling::Vec3Batch& irradiances, std::size_t count,
                              sampling::Vec3Batch& reflected) {
  const Floats d;
  const auto zero = hn::Zero(d);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const Vec3s to_light = load(to_lights, i), arriving = load(irradiances, i);
    const auto cos_l = dot(load(r.shading, i), to_light);
    const auto above =
        hn::And(hn::Gt(cos_l, zero), hn::Gt(dot(load(r.geometric, i), to_light), zero));
    const auto alpha = hn::Load(d, r.alpha.at + i);
    const Vec3s diffuse = load(r.diffuse, i);
    Vec3s f = scaled(cos_l, diffuse);
    if (!hn::AllFalse(d, hn::And(above, hn::Gt(alpha, zero)))) {
      f = r.lobe == LobeModel::Phong ? under_phong(r, i, to_light, cos_l, alpha, diffuse)
                                     : under_lobe(r, i, to_light, cos_l, alpha, diffuse);
    }
    const auto product = [&](FloatVec part, FloatVec light) HWY_ATTR {
      const auto lit = hn::IfThenElseZero(above, hn::Mul(part, light));
      return hn::IfThenZeroElse(hn::Eq(light, zero), lit);
    };
    store({product(f.x, arriving.x), product(f.y, arriving.y), product(f.z, arriving.z)}, reflected,
          i);
  }
}

}  // namespace macula::shading::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::shading {

HWY_EXPORT(reflect_vectors);

void reflect(const ReflectorBatch& reflectors, const sampling::Vec3Batch& to_light,
             const sampling::Vec3Batch& irradiance, std::size_t count,
             sampling::Vec3Batch& reflected) {
  MACULA_DCHECK(count <= sampling::kBatch);
  HWY_DYNAMIC_DISPATCH(reflect_vectors)(reflectors, to_light, irradiance, count, reflected);
}

}  // namespace macula::shading
#endif
