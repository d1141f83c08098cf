#include "server/kernels/lightcuts/surface_parcel.h"

#include <algorithm>
#include <cstring>

namespace macula::kernels::lightcuts {
namespace {

using image::Plane;

/// The part of a row that lies in `rect`.
template <class T>
std::span<T> part(Plane<T>& plane, const image::Rect& rect, int y) {
  return plane.row(y).subspan(static_cast<std::size_t>(rect.x),
                              static_cast<std::size_t>(rect.width));
}
template <class T>
void clear(Plane<T>& plane, const image::Rect& rect) {
  for (int y = rect.y; y < rect.y + rect.height; ++y)
    std::ranges::fill(part(plane, rect, y), T{0.0F});
}
bool is_black(Plane<Rgb>& radiance, const image::Rect& rect) {
  for (int y = rect.y; y < rect.y + rect.height; ++y)
    for (const Rgb& color : part(radiance, rect, y))
      if (color != Rgb{0.0F}) return false;
  return true;
}
/// Most surfaces do not shine.
void carry_radiance(Plane<Rgb>& radiance, const image::Rect& rect, Parcel& parcel) {
  bool black = !parcel.unpacks() && is_black(radiance, rect);
  parcel.value(black);
  if (!black) {
    parcel.rect(radiance, rect);
  } else if (parcel.unpacks()) {
    clear(radiance, rect);
  }
}

/// To the bit: 0 and -0 differ.
bool same(const sampling::Vec3Batch& a, const sampling::Vec3Batch& b, std::size_t n) {
  const auto alike = [bytes = n * sizeof(float)](const float* x, const float* y) {
    return std::memcmp(x, y, bytes) == 0;
  };
  return alike(a.x, b.x) && alike(a.y, b.y) && alike(a.z, b.z);
}
/// Where meshes have no normals of their own both are one.
void carry_normals(shading::ReflectorBatch& batch, std::size_t n, Parcel& parcel) {
  kernels::carry(batch.geometric, n, parcel);
  bool one = !parcel.unpacks() && same(batch.geometric, batch.shading, n);
  parcel.value(one);
  if (!one) {
    kernels::carry(batch.shading, n, parcel);
  } else if (parcel.unpacks()) {
    batch.shading.copy(0, batch.geometric, n);
  }
}

void carry_reflectors(shading::ReflectorBatch& batch, std::size_t n, Parcel& parcel) {
  parcel.value(batch.lobe);
  carry_normals(batch, n, parcel);
  for (auto* each : {&batch.to_eye, &batch.diffuse, &batch.f0, &batch.reflectance})
    kernels::carry(*each, n, parcel);
  for (auto* each : {&batch.f90, &batch.cos_v, &batch.alpha}) kernels::carry(*each, n, parcel);
}

/// Of each cell the point that names it.
void number_points(SurfaceTile& tile) {
  tile.point_of.fill(SurfaceTile::kNone);
  for (std::size_t i = 0; i < tile.points.count; ++i)
    tile.point_of[tile.cell_of[i]] = static_cast<std::uint16_t>(i);
}
/// The plane of normals shows what the points have, 0 where nothing was hit.
void show_normals(const SurfaceTile& tile, Plane<Vec3>& normal) {
  if (normal.empty()) return;
  clear(normal, tile.rect);
  for (std::size_t i = 0; i < tile.points.count; ++i) {
    const image::Pixel at = tile.pixel(i);
    normal(at.x, at.y) = tile.points.reflectors.shading[i];
  }
}

void carry_points(SurfaceTile& tile, Parcel& parcel) {
  ray::LitPoints& points = tile.points;
  parcel.value(points.count), parcel.value(points.sample), parcel.value(points.keeps_whole);
  const std::size_t n = points.count;
  kernels::carry(points.position, n, parcel);
  kernels::carry(points.ray_origin, n, parcel);
  carry_reflectors(points.reflectors, n, parcel);
  parcel.vector(points.whole);
  parcel.vector(points.cut_nodes);
  parcel.vector(points.light_class);
  parcel.values(std::span<std::uint16_t>(tile.cell_of).first(n));
}

}  // namespace

void carry(SurfaceTile& tile, const TilePlanes& planes, Parcel& parcel) {
  ViewBuffers& out = planes.out;
  carry_points(tile, parcel);
  carry_radiance(out.radiance, tile.rect, parcel);
  parcel.rect(out.depth_m, tile.rect);
  parcel.rect(out.surface_id, tile.rect);
  parcel.rect(out.albedo, tile.rect);
  if (!parcel.unpacks()) return;
  number_points(tile);
  give_keys(planes.grid, planes.request.seed, planes.request.frame, tile);
  show_normals(tile, out.normal);
}

}  // namespace macula::kernels::lightcuts
