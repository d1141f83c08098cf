// lights::arriving of virtual_point_light.h is the oracle of these.
#include "server/lights/virtual_light_table.h"
#include "shared/base/check.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/lights/virtual_light_table_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"
#include "server/sampling/vectors_simd.h"

HWY_BEFORE_NAMESPACE();
namespace macula::lights::HWY_NAMESPACE {

using namespace sampling::HWY_NAMESPACE;

HWY_ATTR void virtual_vectors(const VirtualLightTable& table, const LightDraws& draws,
                              const sampling::Vec3Batch& points, std::size_t count,
                              AreaArrivalBatch& out) {
  const Floats d;
  const Ints di;
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.0F);
  const float* rows = table.rows().data();
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto inverse_probability = hn::Load(d, draws.inverse_probability.at + i);
    const auto drawn = hn::Gt(inverse_probability, zero);
    // What was not drawn, and what lies past the last receiver, reads row 0.
    const auto light = hn::IfThenElseZero(hn::RebindMask(di, drawn),
                                          hn::BitCast(di, hn::Load(Words(), draws.light.at + i)));
    const auto row = hn::ShiftLeft<4>(light);
    const Vec3s position = gather_three(rows, row), normal = gather_three(rows + 3, row);
    const Vec3s towards = minus(position, load(points, i));
    const auto distance2 = dot(towards, towards);
    const auto distance = hn::Sqrt(distance2);
    const auto inverse = hn::Div(one, distance);
    const auto height = hn::Neg(dot(normal, towards));
    const auto least2 = hn::GatherIndex(d, rows + 10, row);
    const auto share =
        hn::Div(hn::Mul(hn::Mul(height, inverse), inverse_probability), hn::Max(distance2, least2));
    const auto arrives = hn::And(drawn, hn::Gt(height, zero));
    store(scaled(inverse, towards), out.arrival.to_light, i);
    store(scaled_where(arrives, share, gather_three(rows + 6, row)), out.arrival.irradiance, i);
    store(position, out.position, i);
    store(normal, out.normal, i);
    hn::Store(hn::Max(distance, hn::GatherIndex(d, rows + 9, row)), d, out.span.at + i);
    hn::Store(hn::BitCast(Words(), light), Words(), out.light.at + i);
  }
}

HWY_ATTR void weigh_vectors(const VirtualLightTable& table, std::size_t first, const Vec3& point,
                            const Vec3& normal, std::span<float> weights) {
  const Floats d;
  const auto zero = hn::Zero(d);
  const Vec3s here = broadcast(point), up = broadcast(normal);
  const std::size_t stride = table.columns().size() / VirtualLightTable::kColumns;
  const float* column = table.columns().data() + first;
  for (std::size_t i = 0; i < weights.size(); i += hn::Lanes(d)) {
    const auto read = [&](std::size_t c) HWY_ATTR { return hn::LoadU(d, column + c * stride + i); };
    const Vec3s towards = minus({read(0), read(1), read(2)}, here);
    const Vec3s light_normal{read(3), read(4), read(5)};
    const auto distance2 = dot(towards, towards);
    const auto cosines = hn::Mul(hn::Max(hn::Neg(dot(light_normal, towards)), zero),
                                 hn::Max(dot(up, towards), zero));
    const auto weight =
        hn::Div(hn::Mul(cosines, read(6)), hn::Mul(distance2, hn::Max(distance2, read(7))));
    hn::StoreU(hn::IfThenElseZero(hn::Gt(cosines, zero), weight), d, weights.data() + i);
  }
}

}  // namespace macula::lights::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::lights {

HWY_EXPORT(virtual_vectors);
HWY_EXPORT(weigh_vectors);

void VirtualLightTable::arriving(const LightDraws& draws, const sampling::Vec3Batch& points,
                                 std::size_t count, AreaArrivalBatch& out) const {
  MACULA_DCHECK(!empty() && count <= sampling::kBatch);
  HWY_DYNAMIC_DISPATCH(virtual_vectors)(*this, draws, points, count, out);
}

void VirtualLightTable::weigh(int light_class, const Vec3& point, const Vec3& normal,
                              std::span<float> weights) const {
  MACULA_DCHECK(weights.size() == rounds_);
  HWY_DYNAMIC_DISPATCH(weigh_vectors)(*this, row(light_class, 0), point, normal, weights);
}

}  // namespace macula::lights
#endif
