// The page's way into the table: rows past the caches, and what trees are built from.
#include "server/lights/table_writer.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/lights/table_writer_simd.cpp"
#include "hwy/cache_control.h"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"
#include "server/sampling/vectors_simd.h"

HWY_BEFORE_NAMESPACE();
namespace macula::lights::HWY_NAMESPACE {

using namespace sampling::HWY_NAMESPACE;

HWY_INLINE HWY_ATTR FloatVec middle_of(FloatVec from, FloatVec edge1, FloatVec edge2) {
  const Floats d;
  const auto zero = hn::Zero(d);
  const auto low = hn::Min(zero, hn::Min(edge1, edge2)),
             high = hn::Max(zero, hn::Max(edge1, edge2));
  return hn::MulAdd(hn::Set(d, 0.5F), hn::Add(low, high), from);
}

/// What a page's lights tell together, a light a lane.
struct Found {
  Vec3s low, high;
  FloatVec brightest;
  hn::Mask<Floats> oriented;
};

/// Lanes past the page's last row repeat that one.
HWY_INLINE HWY_ATTR void read_rows(const RowPage& page, std::size_t i, Vec4* places, Found& found) {
  const Floats d;
  const Ints di;
  const auto zero = hn::Zero(d);
  const float* rows = &page.rows.front().position.x;
  const auto last = hn::Set(di, static_cast<std::int32_t>(page.count - 1));
  const auto row = hn::ShiftLeft<4>(hn::Min(hn::Iota(di, static_cast<std::int32_t>(i)), last));
  const auto area = hn::GatherIndex(d, rows + 15, row);
  const auto triangle = hn::Gt(area, zero), lamp = hn::Eq(area, zero);
  const Vec3s edge1 = gather_three(rows + 3, row), emission = gather_three(rows + 12, row);
  Vec3s at = gather_three(rows, row);
  if (!hn::AllFalse(d, triangle)) {
    const Vec3s edge2 = gather_three(rows + 6, row);
    const auto edge = [&](FloatVec value) HWY_ATTR { return hn::IfThenElseZero(triangle, value); };
    at = {middle_of(at.x, edge(edge1.x), edge(edge2.x)),
          middle_of(at.y, edge(edge1.y), edge(edge2.y)),
          middle_of(at.z, edge(edge1.z), edge(edge2.z))};
  }
  const auto luminance = dot(broadcast({0.2126F, 0.7152F, 0.0722F}), emission);
  const auto intensity = hn::IfThenElse(triangle, hn::Mul(area, luminance), luminance);
  hn::StoreInterleaved4(at.x, at.y, at.z, intensity, d, &places[i].x);
  found.low = {hn::Min(found.low.x, at.x), hn::Min(found.low.y, at.y), hn::Min(found.low.z, at.z)};
  found.high = {hn::Max(found.high.x, at.x), hn::Max(found.high.y, at.y),
                hn::Max(found.high.z, at.z)};
  found.brightest = hn::Max(found.brightest, intensity);
  const auto everywhere = hn::And(lamp, hn::Lt(edge1.y, hn::Set(d, -1.0F)));
  found.oriented = hn::Or(found.oriented, hn::Not(everywhere));
}

HWY_INLINE HWY_ATTR void stream_rows(const RowPage& page, PlacedLightRow* to) {
  const hn::CappedTag<float, PlacedLightRow::kFloats> d;
  for (std::size_t i = 0; i < page.count; ++i) {
    const float* from = &page.rows[i].position.x;
    for (std::size_t k = 0; k < PlacedLightRow::kFloats; k += hn::Lanes(d)) {
      hn::Stream(hn::Load(d, from + k), d, &to[i].position.x + k);
    }
  }
}

HWY_INLINE HWY_ATTR Vec3 least_of(const Vec3s& v) {
  const Floats d;
  return {hn::GetLane(hn::MinOfLanes(d, v.x)), hn::GetLane(hn::MinOfLanes(d, v.y)),
          hn::GetLane(hn::MinOfLanes(d, v.z))};
}
HWY_INLINE HWY_ATTR Vec3 greatest_of(const Vec3s& v) {
  const Floats d;
  return {hn::GetLane(hn::MaxOfLanes(d, v.x)), hn::GetLane(hn::MaxOfLanes(d, v.y)),
          hn::GetLane(hn::MaxOfLanes(d, v.z))};
}

HWY_ATTR void store_vectors(const RowPage& page, std::size_t first, PlacedLightTable& table) {
  const Floats d;
  if (page.count == 0) return;
  stream_rows(page, table.rows.data() + first);
  Vec4 places[RowPage::kRows];
  const auto infinite = hn::Inf(d), least = hn::Neg(infinite);
  Found found{{infinite, infinite, infinite},
              {least, least, least},
              hn::Zero(d),
              hn::MaskFromVec(hn::Zero(d))};
  for (std::size_t i = 0; i < page.count; i += hn::Lanes(d)) read_rows(page, i, places, found);
  std::copy_n(places, page.count, table.places.data() + first);
  table.low = glm::min(table.low, least_of(found.low));
  table.high = glm::max(table.high, greatest_of(found.high));
  table.brightest = std::max(table.brightest, hn::GetLane(hn::MaxOfLanes(d, found.brightest)));
  if (!hn::AllFalse(d, found.oriented)) table.oriented = Oriented::Yes;
  hwy::FlushStream();
}

}  // namespace macula::lights::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::lights {

HWY_EXPORT(store_vectors);

void store_page(const RowPage& page, std::size_t first, PlacedLightTable& table) {
  HWY_DYNAMIC_DISPATCH(store_vectors)(page, first, table);
}

}  // namespace macula::lights
#endif
