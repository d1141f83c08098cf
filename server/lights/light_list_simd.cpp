// The scalar functions of light_list.cpp are the oracles of these.
#include "server/lights/light_list_simd.h"

#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/lights/light_list_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"
#include "server/sampling/vectors_simd.h"

HWY_BEFORE_NAMESPACE();
namespace macula::lights::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using namespace sampling::HWY_NAMESPACE;

// ---- emissive triangles ----

/// The triangle whose stretch of [0, 1) holds u: the guide's, or one of the next.
HWY_INLINE HWY_ATTR IntVec choose(const EmitterTable& table, FloatVec u) {
  const Floats d;
  const Ints di;
  const auto last = hn::Set(di, static_cast<std::int32_t>(table.bounds.size()) - 2);
  const auto scale = hn::Set(d, static_cast<float>(table.guide.size()));
  auto light = hn::GatherIndex(di, table.guide.data(), hn::ConvertTo(di, hn::Mul(u, scale)));
  for (;;) {
    const auto end = hn::GatherIndex(d, table.bounds.data() + 1, light);
    const auto beyond = hn::And(hn::RebindMask(di, hn::Ge(u, end)), hn::Lt(light, last));
    if (hn::AllFalse(di, beyond)) return light;
    light = hn::IfThenElse(beyond, hn::Add(light, hn::Set(di, 1)), light);
  }
}

/// Heitz's map, as sampling::uniform_triangle.
HWY_INLINE HWY_ATTR void fold_onto_triangle(FloatVec& u, FloatVec& v) {
  const auto half = hn::Set(Floats(), 0.5F);
  const auto above = hn::Gt(v, u);
  const auto half_u = hn::Mul(half, u), half_v = hn::Mul(half, v);
  const auto b1 = hn::IfThenElse(above, half_u, hn::Sub(u, half_v));
  v = hn::IfThenElse(above, hn::Sub(v, half_u), half_v);
  u = b1;
}

HWY_ATTR void area_vectors(const EmitterTable& table, const sampling::Vec2Batch& us,
                           const sampling::Vec3Batch& points, std::size_t count,
                           AreaArrivalBatch& out) {
  const Floats d;
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.0F);
  const float* rows = table.rows.data();
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto u = hn::Load(d, us.x + i);
    const auto light = choose(table, u);
    const auto before = hn::GatherIndex(d, table.bounds.data(), light);
    const auto share = hn::Sub(hn::GatherIndex(d, table.bounds.data() + 1, light), before);
    // The rest of u inside its stretch is uniform again and chooses along the triangle.
    auto b1 = hn::Min(hn::Max(hn::Div(hn::Sub(u, before), share), zero), one);
    auto b2 = hn::Load(d, us.y + i);
    fold_onto_triangle(b1, b2);
    const auto row = hn::ShiftLeft<4>(light);
    const Vec3s edge1 = gather_three(rows + 3, row), edge2 = gather_three(rows + 6, row);
    const Vec3s position = plus(plus(gather_three(rows, row), b1, edge1), b2, edge2);
    const Vec3s normal = gather_three(rows + 9, row);
    const Vec3s towards = minus(position, load(points, i));
    const auto distance2 = dot(towards, towards);
    const auto facing = hn::Neg(dot(normal, towards));  // cosine at the light times distance
    const auto shines = hn::Gt(facing, zero);
    const auto inverse = hn::Div(one, hn::Sqrt(distance2));
    const auto area = hn::GatherIndex(d, rows + 15, row);
    const auto strength =
        hn::Div(hn::Mul(hn::Mul(facing, area), inverse), hn::Mul(distance2, share));
    store(scaled(inverse, towards), out.arrival.to_light, i);
    store(scaled_where(shines, strength, gather_three(rows + 12, row)), out.arrival.irradiance, i);
    store(position, out.position, i);
    store(normal, out.normal, i);
    const auto edges2 = hn::Max(dot(edge1, edge1), dot(edge2, edge2));
    hn::Store(hn::Sqrt(hn::Max(distance2, edges2)), d, out.span.at + i);
    hn::Store(b1, d, out.barycentric.x + i);
    hn::Store(b2, d, out.barycentric.y + i);
    hn::Store(hn::BitCast(Words(), light), Words(), out.light.at + i);
  }
}

// ---- punctual lights ----

HWY_ATTR void directional_vectors(const scene::Light& light, std::size_t count, ArrivalBatch& out) {
  for (std::size_t i = 0; i < count; i += hn::Lanes(Floats())) {
    store(broadcast(-light.direction), out.to_light, i);
    store(broadcast(light.intensity), out.irradiance, i);
  }
}

/// glTF's falloff (cos - outer) / (inner - outer), clamped and squared, for a spot; 1 for a point.
struct Cone {
  Vec3 axis{0.0F};
  float cos_outer = -2.0F, cos_inner = -1.5F;
};
Cone cone_of(const scene::Light& light) {
  if (light.kind != scene::LightKind::Spot) return {};
  return {light.direction, static_cast<float>(std::cos(light.outer_cone.value())),
          static_cast<float>(std::cos(light.inner_cone.value()))};
}

HWY_INLINE HWY_ATTR FloatVec falloff(const Cone& cone, const Vec3s& to_light) {
  const Floats d;
  const auto one = hn::Set(d, 1.0F);
  const auto cosine = hn::Neg(dot(broadcast(cone.axis), to_light));
  const auto outer = hn::Set(d, cone.cos_outer), inner = hn::Set(d, cone.cos_inner);
  const auto ramp = hn::Div(hn::Sub(cosine, outer), hn::Sub(inner, outer));
  // A cone without a ramp divides by zero; the two comparisons decide it.
  const auto inside = hn::IfThenElse(hn::Ge(cosine, inner), one, hn::Mul(ramp, ramp));
  return hn::IfThenElseZero(hn::Gt(cosine, outer), inside);
}

HWY_ATTR void point_vectors(const scene::Light& light, const sampling::Vec3Batch& points,
                            std::size_t count, ArrivalBatch& out) {
  const Floats d;
  const Vec3s position = broadcast(Vec3(light.position)), intensity = broadcast(light.intensity);
  const Cone cone = cone_of(light);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const Vec3s towards = minus(position, load(points, i));
    const auto distance2 = dot(towards, towards);
    const Vec3s to_light = scaled(hn::Div(hn::Set(d, 1.0F), hn::Sqrt(distance2)), towards);
    const auto ramp = falloff(cone, to_light);
    const auto arrives = hn::And(hn::Gt(ramp, hn::Zero(d)), hn::Gt(distance2, hn::Zero(d)));
    store(to_light, out.to_light, i);
    store(scaled_where(arrives, hn::Div(ramp, distance2), intensity), out.irradiance, i);
  }
}

}  // namespace macula::lights::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::lights {

HWY_EXPORT(area_vectors);
HWY_EXPORT(directional_vectors);
HWY_EXPORT(point_vectors);

void arriving_from_table(const EmitterTable& table, const sampling::Vec2Batch& u,
                         const sampling::Vec3Batch& points, std::size_t count,
                         AreaArrivalBatch& out) {
  HWY_DYNAMIC_DISPATCH(area_vectors)(table, u, points, count, out);
}

void arriving(const scene::Light& light, const sampling::Vec3Batch& points, std::size_t count,
              ArrivalBatch& out) {
  if (light.kind == scene::LightKind::Directional) {
    HWY_DYNAMIC_DISPATCH(directional_vectors)(light, count, out);
  } else {
    HWY_DYNAMIC_DISPATCH(point_vectors)(light, points, count, out);
  }
}

}  // namespace macula::lights
#endif
