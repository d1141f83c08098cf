// lights::arriving, of lamps and of virtual lights, and LightList::emission are the oracles of
// this.
#include "server/lights/placed_lights_simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/lights/placed_lights_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"
#include "server/sampling/vectors_simd.h"

HWY_BEFORE_NAMESPACE();
namespace macula::lights::HWY_NAMESPACE {

using namespace sampling::HWY_NAMESPACE;

struct Barycentric {
  FloatVec b1, b2;
};
/// Heitz's map, as sampling::uniform_triangle; both 0 where the light is a point.
template <class Mask>
HWY_INLINE HWY_ATTR Barycentric on_triangle(Mask triangle, FloatVec u, FloatVec v) {
  const auto half = hn::Set(Floats(), 0.5F);
  const auto above = hn::Gt(v, u);
  const auto half_u = hn::Mul(half, u), half_v = hn::Mul(half, v);
  return {hn::IfThenElseZero(triangle, hn::IfThenElse(above, half_u, hn::Sub(u, half_v))),
          hn::IfThenElseZero(triangle, hn::IfThenElse(above, hn::Sub(v, half_u), half_v))};
}

/// glTF's falloff for a spot; 1 for a point, whose cone has no edge.
HWY_INLINE HWY_ATTR FloatVec falloff(FloatVec cosine, FloatVec outer, FloatVec inner) {
  const Floats d;
  const auto ramp = hn::Div(hn::Sub(cosine, outer), hn::Sub(inner, outer));
  // A cone without a ramp divides by zero; the two comparisons decide it.
  const auto inside = hn::IfThenElse(hn::Ge(cosine, inner), hn::Set(d, 1.0F), hn::Mul(ramp, ramp));
  return hn::IfThenElseZero(hn::Gt(cosine, outer), inside);
}

HWY_ATTR void placed_vectors(const PlacedLightTable& table, const LightDraws& draws,
                             const sampling::Vec2Batch& us, const sampling::Vec3Batch& points,
                             std::size_t count, AreaArrivalBatch& out) {
  const Floats d;
  const Ints di;
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.0F);
  const float* rows = table.floats();
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto inverse_probability = hn::Load(d, draws.inverse_probability.at + i);
    const auto drawn = hn::Gt(inverse_probability, zero);
    // What was not drawn, and what lies past the last receiver, reads light 0.
    const auto light = hn::IfThenElseZero(hn::RebindMask(di, drawn),
                                          hn::BitCast(di, hn::Load(Words(), draws.light.at + i)));
    const auto row = hn::ShiftLeft<4>(light);
    const auto area = hn::GatherIndex(d, rows + 15, row);
    const auto triangle = hn::Gt(area, zero), lamp = hn::Eq(area, zero);
    const Barycentric at = on_triangle(triangle, hn::Load(d, us.x + i), hn::Load(d, us.y + i));
    const Vec3s edge1 = gather_three(rows + 3, row), edge2 = gather_three(rows + 6, row);
    const Vec3s normal = gather_three(rows + 9, row);
    const Vec3s position = plus(plus(gather_three(rows, row), at.b1, edge1), at.b2, edge2);
    const Vec3s towards = minus(position, load(points, i));
    const auto distance2 = dot(towards, towards);
    const auto inverse = hn::Div(one, hn::Sqrt(distance2));
    const auto cosine = hn::Neg(hn::Mul(inverse, dot(normal, towards)));
    const auto of_surface = hn::IfThenElse(triangle, hn::Mul(cosine, area), cosine);
    const auto of_lamp = falloff(cosine, edge1.x, edge1.y);
    const auto emitted =
        hn::Mul(hn::IfThenElse(lamp, of_lamp, of_surface), hn::Div(inverse_probability, distance2));
    const auto arrives = hn::And(drawn, hn::And(hn::Gt(emitted, zero), hn::Gt(distance2, zero)));
    store(scaled(inverse, towards), out.arrival.to_light, i);
    store(scaled_where(arrives, emitted, gather_three(rows + 12, row)), out.arrival.irradiance, i);
    store(position, out.position, i);
    store(scaled_where(hn::Not(lamp), one, normal), out.normal, i);
    // Of a lamp only the distance counts: its ray's end is not moved.
    const auto edges2 = hn::Max(dot(edge1, edge1), dot(edge2, edge2));
    hn::Store(hn::Sqrt(hn::Max(distance2, edges2)), d, out.span.at + i);
    hn::Store(at.b1, d, out.barycentric.x + i);
    hn::Store(at.b2, d, out.barycentric.y + i);
    hn::Store(hn::BitCast(Words(), light), Words(), out.light.at + i);
  }
}

}  // namespace macula::lights::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::lights {

HWY_EXPORT(placed_vectors);

void arriving_from_placed(const PlacedLightTable& table, const LightDraws& draws,
                          const sampling::Vec2Batch& u, const sampling::Vec3Batch& points,
                          std::size_t count, AreaArrivalBatch& out) {
  HWY_DYNAMIC_DISPATCH(placed_vectors)(table, draws, u, points, count, out);
}

}  // namespace macula::lights
#endif
