// SurfaceTable::at in vectors; the function of one point is its oracle. Places are computed in
// double, as there.
#include "server/shading/surface_batch.h"

#include <algorithm>
#include <span>

#include "server/shading/surface.h"
#include "shared/base/check.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/shading/surface_batch_simd.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"
#include "server/sampling/vectors_simd.h"

#ifndef MACULA_SHADING_MESH_ARRAYS
#define MACULA_SHADING_MESH_ARRAYS
namespace macula::shading {

/// One placed mesh as loops that gather see it; null: the mesh has none.
struct MeshArrays {
  const std::int32_t* triangles;  ///< three a triangle
  const float *positions, *normals, *texcoords, *uv_per_unit;
  const DMat3& world_from_object;
  const DVec3& translation;
  const Mat3& normal_from_object;
  float meters_per_unit, stretch, largest_translation;
};

}  // namespace macula::shading
#endif

HWY_BEFORE_NAMESPACE();
namespace macula::shading::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using namespace sampling::HWY_NAMESPACE;
using Doubles = hn::RepartitionToWide<Floats>;
using HalfFloats = hn::Half<Floats>;
using DoubleVec = hn::Vec<Doubles>;

/// Of the vertices that a vector of points lies between, as first elements of their rows.
struct Corners {
  IntVec a, b, c;
};
HWY_INLINE HWY_ATTR Corners corners(const std::int32_t* triangles, IntVec triangle) {
  const Ints di;
  const auto row = hn::Mul(triangle, hn::Set(di, 3));
  return {hn::GatherIndex(di, triangles, row), hn::GatherIndex(di, triangles + 1, row),
          hn::GatherIndex(di, triangles + 2, row)};
}
HWY_INLINE HWY_ATTR Vec3s row_of_three(const float* rows, IntVec index) {
  return gather_three(rows, hn::Mul(index, hn::Set(Ints(), 3)));
}

HWY_INLINE HWY_ATTR FloatVec largest_coordinate(const Vec3s& v) {
  return hn::Max(hn::Max(hn::Abs(v.x), hn::Abs(v.y)), hn::Abs(v.z));
}
HWY_INLINE HWY_ATTR Vec3s cross(const Vec3s& a, const Vec3s& b) {
  return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
          hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
}
/// Zero stays zero.
HWY_INLINE HWY_ATTR Vec3s unit(const Vec3s& v) {
  const Floats d;
  const auto length = hn::Sqrt(dot(v, v));
  const auto some = hn::Gt(length, hn::Zero(d));
  return scaled_where(some, hn::Div(hn::Set(d, 1.0F), length), v);
}
HWY_INLINE HWY_ATTR Vec3s times(const Mat3& m, const Vec3s& v) {
  return plus(plus(scaled(v.x, broadcast(m[0])), v.y, broadcast(m[1])), v.z, broadcast(m[2]));
}

HWY_INLINE HWY_ATTR DoubleVec lower(FloatVec v) {
  return hn::PromoteTo(Doubles(), hn::LowerHalf(v));
}
HWY_INLINE HWY_ATTR DoubleVec upper(FloatVec v) {
  return hn::PromoteTo(Doubles(), hn::UpperHalf(HalfFloats(), v));
}
HWY_INLINE HWY_ATTR FloatVec rounded(DoubleVec low, DoubleVec high) {
  const HalfFloats half;
  return hn::Combine(Floats(), hn::DemoteTo(half, high), hn::DemoteTo(half, low));
}
/// p + u e1 + v e2
HWY_INLINE HWY_ATTR DoubleVec along(DoubleVec p, DoubleVec u, DoubleVec e1, DoubleVec v,
                                    DoubleVec e2) {
  return hn::MulAdd(v, e2, hn::MulAdd(u, e1, p));
}
HWY_INLINE HWY_ATTR DoubleVec placed(const MeshArrays& mesh, int row, DoubleVec x, DoubleVec y,
                                     DoubleVec z) {
  const Doubles d;
  const DMat3& m = mesh.world_from_object;
  const auto start = hn::MulAdd(hn::Set(d, m[0][row]), x, hn::Set(d, mesh.translation[row]));
  return hn::MulAdd(hn::Set(d, m[2][row]), z, hn::MulAdd(hn::Set(d, m[1][row]), y, start));
}
HWY_INLINE HWY_ATTR Vec3s position(const MeshArrays& mesh, const Vec3s& p, FloatVec u,
                                   const Vec3s& e1, FloatVec v, const Vec3s& e2) {
  const auto ul = lower(u), uh = upper(u), vl = lower(v), vh = upper(v);
  const auto xl = along(lower(p.x), ul, lower(e1.x), vl, lower(e2.x));
  const auto xh = along(upper(p.x), uh, upper(e1.x), vh, upper(e2.x));
  const auto yl = along(lower(p.y), ul, lower(e1.y), vl, lower(e2.y));
  const auto yh = along(upper(p.y), uh, upper(e1.y), vh, upper(e2.y));
  const auto zl = along(lower(p.z), ul, lower(e1.z), vl, lower(e2.z));
  const auto zh = along(upper(p.z), uh, upper(e1.z), vh, upper(e2.z));
  return {rounded(placed(mesh, 0, xl, yl, zl), placed(mesh, 0, xh, yh, zh)),
          rounded(placed(mesh, 1, xl, yl, zl), placed(mesh, 1, xh, yh, zh)),
          rounded(placed(mesh, 2, xl, yl, zl), placed(mesh, 2, xh, yh, zh))};
}

HWY_ATTR void surfaces_at(const MeshArrays& mesh, const PointsOnTriangles& points,
                          SurfaceBatch& out) {
  const Floats d;
  const Ints di;
  const auto one = hn::Set(d, 1.0F), zero = hn::Zero(d);
  for (std::size_t i = 0; i < points.count; i += hn::Lanes(d)) {
    const auto triangle = hn::BitCast(di, hn::Load(Words(), points.triangle.at + i));
    const auto u = hn::Load(d, points.barycentric.x + i);
    const auto v = hn::Load(d, points.barycentric.y + i);
    const auto w = hn::Sub(hn::Sub(one, u), v);
    const Corners at = corners(mesh.triangles, triangle);
    const Vec3s p0 = row_of_three(mesh.positions, at.a);
    const Vec3s e1 = minus(row_of_three(mesh.positions, at.b), p0);
    const Vec3s e2 = minus(row_of_three(mesh.positions, at.c), p0);
    store(position(mesh, p0, u, e1, v, e2), out.position, i);
    const Vec3s geometric = unit(times(mesh.normal_from_object, cross(e1, e2)));
    store(geometric, out.geometric, i);
    Vec3s shading = geometric;
    if (mesh.normals != nullptr) {
      const Vec3s blended = plus(
          plus(scaled(w, row_of_three(mesh.normals, at.a)), u, row_of_three(mesh.normals, at.b)), v,
          row_of_three(mesh.normals, at.c));
      const Vec3s normal = unit(times(mesh.normal_from_object, blended));
      const auto some = hn::Gt(largest_coordinate(normal), zero);
      shading = {hn::IfThenElse(some, normal.x, geometric.x),
                 hn::IfThenElse(some, normal.y, geometric.y),
                 hn::IfThenElse(some, normal.z, geometric.z)};
    }
    store(shading, out.shading, i);
    auto uv_x = zero, uv_y = zero;
    if (mesh.texcoords != nullptr) {
      const auto two = [&](IntVec index) HWY_ATTR { return hn::Add(index, index); };
      const IntVec a = two(at.a), b = two(at.b), c = two(at.c);
      const float* x = mesh.texcoords;
      uv_x =
          hn::MulAdd(v, hn::GatherIndex(d, x, c),
                     hn::MulAdd(u, hn::GatherIndex(d, x, b), hn::Mul(w, hn::GatherIndex(d, x, a))));
      uv_y = hn::MulAdd(
          v, hn::GatherIndex(d, x + 1, c),
          hn::MulAdd(u, hn::GatherIndex(d, x + 1, b), hn::Mul(w, hn::GatherIndex(d, x + 1, a))));
    }
    hn::Store(uv_x, d, out.uv.x + i);
    hn::Store(uv_y, d, out.uv.y + i);
    const auto edge = hn::Max(largest_coordinate(e1), largest_coordinate(e2));
    hn::Store(
        hn::Max(hn::Mul(hn::Set(d, mesh.stretch), edge), hn::Set(d, mesh.largest_translation)), d,
        out.span_m.at + i);
    auto density = zero;
    if (mesh.uv_per_unit != nullptr) {
      density =
          hn::Div(hn::GatherIndex(d, mesh.uv_per_unit, triangle), hn::Set(d, mesh.meters_per_unit));
    }
    hn::Store(density, d, out.uv_per_meter.at + i);
  }
}

}  // namespace macula::shading::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace macula::shading {
namespace {

const float* floats(std::span<const Vec3> rows) {
  return rows.empty() ? nullptr : &rows.front().x;
}

}  // namespace

HWY_EXPORT(surfaces_at);

void SurfaceTable::at(scene::Index instance, const PointsOnTriangles& points,
                      SurfaceBatch& out) const {
  MACULA_DCHECK(points.count <= sampling::kBatch);
  if (points.count == 0) return;
  const Placed& placed = instances_[instance];
  const scene::Mesh& mesh = *placed.mesh;
  const bool has_density = !placed.uv_per_unit->empty() && placed.meters_per_unit > 0.0F;
  const Vec3 translation = glm::abs(Vec3(placed.translation));
  const MeshArrays arrays{reinterpret_cast<const std::int32_t*>(mesh.triangles.data()),
                          floats(placed.positions),
                          floats(placed.normals),
                          mesh.texcoords.empty() ? nullptr : &mesh.texcoords.front().x,
                          has_density ? placed.uv_per_unit->data() : nullptr,
                          placed.world_from_object,
                          placed.translation,
                          placed.normal_from_object,
                          placed.meters_per_unit,
                          placed.stretch,
                          std::max({translation.x, translation.y, translation.z})};
  HWY_DYNAMIC_DISPATCH(surfaces_at)(arrays, points, out);
}

}  // namespace macula::shading
#endif
