#include "server/kernels/sphere/lighting_simd.h"

#include <limits>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/kernels/sphere/lighting_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"
#include "server/sampling/vectors_simd.h"

HWY_BEFORE_NAMESPACE();
namespace macula::kernels::sphere::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using namespace sampling::HWY_NAMESPACE;

HWY_INLINE HWY_ATTR FloatVec set(float value) {
  return hn::Set(Floats(), value);
}
HWY_INLINE HWY_ATTR Vec3s times(const Vec3s& a, const Vec3s& b) {
  return {hn::Mul(a.x, b.x), hn::Mul(a.y, b.y), hn::Mul(a.z, b.z)};
}

HWY_ATTR void place_vectors(const sampling::FloatBatch& ways, const Vec3& forward, float per_sample,
                            SurfaceBatch& surfaces, sampling::FloatBatch& depths) {
  const Floats d;
  const Vec3s ahead = broadcast(forward);
  for (std::size_t i = 0; i < surfaces.count; i += hn::Lanes(d)) {
    const Vec3s direction = load(surfaces.position, i);
    const auto t = hn::Load(d, ways.at + i);
    const auto depth = hn::Mul(t, dot(direction, ahead));
    const auto cell = hn::Mul(hn::Sqrt(hn::Load(d, surfaces.cell_m.at + i)), depth);
    hn::Store(depth, d, depths.at + i);
    hn::Store(cell, d, surfaces.cell_m.at + i);
    hn::Store(hn::Mul(cell, set(per_sample)), d, surfaces.footprint_m.at + i);
    store(scaled(t, direction), surfaces.position, i);
    store({hn::Neg(direction.x), hn::Neg(direction.y), hn::Neg(direction.z)}, surfaces.to_eye, i);
  }
}

// With n the normal, t the direction of sight laid into the surface and b across both, n n' + t t'
// + b b' = 1 gives b's parts; where the eye looks straight on, every direction is across.
HWY_ATTR void cover_vectors(const SurfaceBatch& points, const Vec3& eye_at, LitBatch& lit) {
  constexpr float kLeastCosine = 1.0F / 64.0F;  // beyond it, blur would spread to the horizon
  const Floats d;
  const auto one = set(1.0F), zero = hn::Zero(d);
  const Vec3s eye = broadcast(eye_at);
  for (std::size_t i = 0; i < points.count; i += hn::Lanes(d)) {
    const Vec3s n = load(points.normal, i), to_eye = load(points.to_eye, i);
    const auto width = hn::Load(d, points.footprint_m.at + i);
    const auto cosine = dot(n, to_eye);
    const Vec3s laid = plus(to_eye, hn::Neg(cosine), n);
    const auto square = dot(laid, laid);
    const auto slanted = hn::Gt(square, zero);
    const auto stretch = hn::Div(one, hn::Max(hn::Abs(cosine), set(kLeastCosine)));
    const auto inverse = hn::Div(one, hn::IfThenElse(slanted, square, one));
    const auto side = [&](FloatVec n_part, FloatVec laid_part) HWY_ATTR {
      const auto along2 = hn::Mul(hn::Mul(laid_part, laid_part), inverse);
      const auto across2 = hn::Max(hn::Sub(hn::NegMulAdd(n_part, n_part, one), along2), zero);
      const auto parts = hn::MulAdd(hn::Mul(stretch, stretch), along2, across2);
      return hn::Mul(width, hn::IfThenElse(slanted, hn::Sqrt(parts), one));
    };
    store({side(n.x, laid.x), side(n.y, laid.y), side(n.z, laid.z)}, lit.box, i);
    store(plus(eye, load(points.position, i)), lit.world, i);
  }
}

HWY_INLINE HWY_ATTR void blend(hn::Mask<Floats> where, const Vec3s& value, sampling::Vec3Batch& to,
                               std::size_t i) {
  const Vec3s before = load(to, i);
  store({hn::IfThenElse(where, value.x, before.x), hn::IfThenElse(where, value.y, before.y),
         hn::IfThenElse(where, value.z, before.z)},
        to, i);
}

HWY_ATTR void matte_vectors(const SurfaceBatch& points, scene::Index material, const MatteRow& row,
                            const sampling::FloatBatch* share, LitBatch& lit) {
  const Floats d;
  const Vec3s base = broadcast(row.base), second = broadcast(row.second);
  const auto diffuse = set(row.diffuse), inverse_pi = set(std::numbers::inv_pi_v<float>);
  const auto wanted = hn::Set(Words(), material);
  for (std::size_t i = 0; i < points.count; i += hn::Lanes(d)) {
    const auto own = hn::Eq(hn::LoadU(Words(), points.material + i), wanted);
    if (hn::AllFalse(Words(), own)) continue;
    const auto where = hn::RebindMask(d, own);
    Vec3s color = base;
    if (share != nullptr) {
      const auto s = hn::Load(d, share->at + i);
      color = plus(scaled(hn::Sub(set(1.0F), s), base), s, second);
    }
    const Vec3s albedo = scaled(diffuse, color);
    blend(where, color, lit.base_color, i);
    blend(where, albedo, lit.reflectors.reflectance, i);
    blend(where, scaled(inverse_pi, albedo), lit.reflectors.diffuse, i);
    blend(where, broadcast(row.emission), lit.radiance, i);
  }
}

HWY_ATTR void face_vectors(const SurfaceBatch& points, LitBatch& lit) {
  const Floats d;
  const auto zero = hn::Zero(d);
  shading::ReflectorBatch& r = lit.reflectors;
  for (std::size_t i = 0; i < points.count; i += hn::Lanes(d)) {
    const Vec3s n = load(points.normal, i), to_eye = load(points.to_eye, i);
    const auto away = hn::Lt(dot(n, to_eye), zero);
    const Vec3s seen{hn::IfThenElse(away, hn::Neg(n.x), n.x),
                     hn::IfThenElse(away, hn::Neg(n.y), n.y),
                     hn::IfThenElse(away, hn::Neg(n.z), n.z)};
    store(seen, r.shading, i);
    store(seen, r.geometric, i);
    store(to_eye, r.to_eye, i);
    store({zero, zero, zero}, r.f0, i);
    hn::Store(zero, d, r.f90.at + i);
    hn::Store(set(1.0F), d, r.cos_v.at + i);
    hn::Store(zero, d, r.alpha.at + i);
  }
}

HWY_ATTR void add_vectors(const sampling::Vec3Batch& light, const sampling::FloatBatch* share,
                          std::size_t count, sampling::Vec3Batch& radiance) {
  const Floats d;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto s = share != nullptr ? hn::Load(d, share->at + i) : set(1.0F);
    store(plus(load(radiance, i), s, load(light, i)), radiance, i);
  }
}

HWY_ATTR void add_reflected_vectors(const Rgb& light, const sampling::Vec3Batch& reflectance,
                                    const sampling::FloatBatch* share, std::size_t count,
                                    sampling::Vec3Batch& radiance) {
  const Floats d;
  const Vec3s arriving = broadcast(light);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto s = share != nullptr ? hn::Load(d, share->at + i) : set(1.0F);
    store(plus(load(radiance, i), s, times(arriving, load(reflectance, i))), radiance, i);
  }
}

HWY_ATTR std::uint64_t blacken_vectors(std::size_t count, sampling::Vec3Batch& radiance) {
  const Floats d;
  const auto most = set(std::numeric_limits<float>::max());
  std::uint64_t found = 0;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const Vec3s r = load(radiance, i);
    const auto finite = hn::And(hn::Le(hn::Abs(r.x), most),
                                hn::And(hn::Le(hn::Abs(r.y), most), hn::Le(hn::Abs(r.z), most)));
    if (hn::AllTrue(d, finite)) continue;
    store({hn::IfThenElseZero(finite, r.x), hn::IfThenElseZero(finite, r.y),
           hn::IfThenElseZero(finite, r.z)},
          radiance, i);
    found += hn::CountTrue(d, hn::AndNot(finite, hn::FirstN(d, count - i)));
  }
  return found;
}

}  // namespace macula::kernels::sphere::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::kernels::sphere {

HWY_EXPORT(place_vectors);
HWY_EXPORT(cover_vectors);
HWY_EXPORT(matte_vectors);
HWY_EXPORT(face_vectors);
HWY_EXPORT(add_vectors);
HWY_EXPORT(add_reflected_vectors);
HWY_EXPORT(blacken_vectors);

void place_surfaces(const sampling::FloatBatch& t, const Vec3& forward, float per_sample,
                    SurfaceBatch& surfaces, sampling::FloatBatch& depth_m) {
  HWY_DYNAMIC_DISPATCH(place_vectors)(t, forward, per_sample, surfaces, depth_m);
}
void cover(const SurfaceBatch& points, const Vec3& eye, LitBatch& lit) {
  HWY_DYNAMIC_DISPATCH(cover_vectors)(points, eye, lit);
}
void take_matte(const SurfaceBatch& points, scene::Index material, const MatteRow& row,
                const sampling::FloatBatch* share, LitBatch& lit) {
  HWY_DYNAMIC_DISPATCH(matte_vectors)(points, material, row, share, lit);
}
void face_eye(const SurfaceBatch& points, LitBatch& lit) {
  HWY_DYNAMIC_DISPATCH(face_vectors)(points, lit);
}
void add(const sampling::Vec3Batch& light, const sampling::FloatBatch* share, std::size_t count,
         sampling::Vec3Batch& radiance) {
  HWY_DYNAMIC_DISPATCH(add_vectors)(light, share, count, radiance);
}
void add_reflected(const Rgb& light, const sampling::Vec3Batch& reflectance,
                   const sampling::FloatBatch* share, std::size_t count,
                   sampling::Vec3Batch& radiance) {
  HWY_DYNAMIC_DISPATCH(add_reflected_vectors)(light, reflectance, share, count, radiance);
}
std::uint64_t blacken_non_finite(std::size_t count, sampling::Vec3Batch& radiance) {
  return HWY_DYNAMIC_DISPATCH(blacken_vectors)(count, radiance);
}

}  // namespace macula::kernels::sphere
#endif
