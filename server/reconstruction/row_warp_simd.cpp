#include "server/reconstruction/row_warp.h"

#include "shared/base/check.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/reconstruction/row_warp_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

#ifndef MACULA_ROW_WARP_ARGUMENTS
#define MACULA_ROW_WARP_ARGUMENTS
namespace macula::reconstruction {

/// A direction then is `base` + tangent_x * `right`; a point adds inverse depth * `origin`.
struct RowArguments {
  Vec3 base, right, origin;
  const AxisLocator& x_then;
  const AxisLocator& y_then;
};

}  // namespace macula::reconstruction
#endif

HWY_BEFORE_NAMESPACE();
namespace macula::reconstruction::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <class D>
HWY_INLINE HWY_ATTR hn::Vec<D> locate(D d, hn::Vec<D> tangent, const AxisLocator& axis) {
  const auto place =
      hn::Mul(hn::Sub(tangent, hn::Set(d, axis.first())), hn::Set(d, axis.per_tangent()));
  if (axis.equal_steps()) return place;
  const hn::RebindToSigned<D> di;
  const auto last = hn::Set(d, static_cast<float>(axis.table().size() - 2));
  const auto bucket = hn::Min(hn::Max(hn::Floor(place), hn::Zero(d)), last);
  const auto index = hn::ConvertTo(di, bucket);
  const auto low = hn::GatherIndex(d, axis.table().data(), index);
  const auto high = hn::GatherIndex(d, axis.table().data() + 1, index);
  return hn::Add(low, hn::Mul(hn::Sub(place, bucket), hn::Sub(high, low)));
}

template <class D>
HWY_INLINE HWY_ATTR void warp_at(D d, const RowArguments& row, const float* tangent_x,
                                 const float* inverse_depth, float* x, float* y, float* depth) {
  const auto t = hn::LoadU(d, tangent_x), w = hn::LoadU(d, inverse_depth);
  const auto along = [&](int axis) HWY_ATTR {
    const auto direction =
        hn::Add(hn::Set(d, row.base[axis]), hn::Mul(t, hn::Set(d, row.right[axis])));
    return hn::Add(direction, hn::Mul(w, hn::Set(d, row.origin[axis])));
  };
  const auto ahead = hn::Div(hn::Set(d, -1.0F), along(2));
  hn::StoreU(locate(d, hn::Mul(along(0), ahead), row.x_then), d, x);
  hn::StoreU(locate(d, hn::Neg(hn::Mul(along(1), ahead)), row.y_then), d, y);
  // Behind the eye then also what is infinitely far must come out negative.
  const auto behind = hn::Lt(ahead, hn::Zero(d));
  hn::StoreU(hn::IfThenElse(behind, hn::Set(d, -1.0F), hn::Mul(w, ahead)), d, depth);
}

/// The last cells one by one, by the same operations: a cell's bits do not depend on its place.
HWY_ATTR void warp_row(const RowArguments& row, const float* tangent_x, const float* inverse_depth,
                       std::size_t width, RowPlaces& places) {
  const hn::ScalableTag<float> d;
  const hn::CappedTag<float, 1> d1;
  std::size_t i = 0;
  for (; i + hn::Lanes(d) <= width; i += hn::Lanes(d)) {
    warp_at(d, row, tangent_x + i, inverse_depth + i, places.x.data() + i, places.y.data() + i,
            places.inverse_depth.data() + i);
  }
  for (; i < width; ++i) {
    warp_at(d1, row, tangent_x + i, inverse_depth + i, places.x.data() + i, places.y.data() + i,
            places.inverse_depth.data() + i);
  }
}

}  // namespace macula::reconstruction::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::reconstruction {
namespace {

std::vector<float> centres(const std::vector<float>& edges) {
  std::vector<float> middle(edges.size() - 1);
  for (std::size_t i = 0; i < middle.size(); ++i) {
    middle[i] = edges[i] + 0.5F * (edges[i + 1] - edges[i]);
  }
  return middle;
}

}  // namespace

HWY_EXPORT(warp_row);

RowWarp::RowWarp(const Pose& world_from_now, const PixelGrid& grid_now, const Pose& world_from_then,
                 const PixelGrid& grid_then)
    : eye_(world_from_now, world_from_then),
      tangent_x_(centres(grid_now.x_edges)),
      tangent_y_(centres(grid_now.y_edges)),
      x_then_(grid_then.x_edges),
      y_then_(grid_then.y_edges) {}

RowWarp::Eye::Eye(const Pose& world_from_now, const Pose& world_from_then) {
  const Pose then_from_now = math::inverse(world_from_then) * world_from_now;
  rotation = Mat3(glm::mat3_cast(then_from_now.rotation));
  origin = Vec3(then_from_now.position);
}

RowWarp::Place RowWarp::then(int x, int y, float inverse_depth, const Eye& eye) const {
  const Vec3 direction =
      eye.rotation * math::direction_from_tangent(Vec2{tangent_x_[x], tangent_y_[y]});
  const Vec3 point = direction + inverse_depth * eye.origin;
  if (!(point.z < 0.0F)) return {0.0F, 0.0F, -1.0F};
  const Vec2 tangent = math::tangent_from_direction(point);
  return {x_then_.locate(tangent.x), y_then_.locate(tangent.y), inverse_depth / -point.z};
}

float RowWarp::inverse_depth_now(const Vec2& tangent_then, float inverse_depth_then) const {
  const Vec3 seen = math::direction_from_tangent(tangent_then) - inverse_depth_then * eye_.origin;
  const float ahead = -glm::dot(eye_.rotation[2], seen);
  return ahead > 0.0F ? inverse_depth_then / ahead : -1.0F;
}

void RowWarp::row(int y, std::span<const float> inverse_depth, RowPlaces& places) const {
  row(y, tangent_x_, inverse_depth, places);
}

void RowWarp::row(int y, std::span<const float> tangent_x, std::span<const float> inverse_depth,
                  RowPlaces& places) const {
  MACULA_CHECK(inverse_depth.size() == tangent_x.size());
  places.resize(inverse_depth.size());
  const Vec3 base = eye_.rotation * math::direction_from_tangent(Vec2{0.0F, tangent_y_[y]});
  const RowArguments arguments{base, eye_.rotation[0], eye_.origin, x_then_, y_then_};
  HWY_DYNAMIC_DISPATCH(warp_row)
  (arguments, tangent_x.data(), inverse_depth.data(), inverse_depth.size(), places);
}

}  // namespace macula::reconstruction
#endif
