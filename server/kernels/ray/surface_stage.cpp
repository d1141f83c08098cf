#include "server/kernels/ray/surface_stage.h"

#include <algorithm>

#include "server/kernels/ray/surface_view.h"

namespace macula::kernels::ray {
namespace {

/// Whole vectors are read, of the widest instruction set: 16 floats.
constexpr std::size_t kWidest = 16;

}  // namespace

HitGroups::HitGroups(const visibility::HitStream& hits, std::size_t count) {
  std::uint32_t instance[sampling::kBatch];
  std::uint16_t group_of[sampling::kBatch], size[sampling::kBatch];
  std::size_t group = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!hits.hit(static_cast<int>(i))) continue;
    const std::uint32_t met = hits.instance[i];
    if (groups_ == 0 || instance[group] != met) {
      group = static_cast<std::size_t>(std::find(instance, instance + groups_, met) - instance);
      if (group == groups_) instance[group] = met, size[group] = 0, ++groups_;
    }
    group_of[i] = static_cast<std::uint16_t>(group);
    ++size[group];
  }
  std::uint16_t next[sampling::kBatch], sum = 0;
  for (std::size_t g = 0; g < groups_; ++g) {
    first_[g] = next[g] = sum;
    sum = static_cast<std::uint16_t>(sum + size[g]);
  }
  first_[groups_] = sum;
  for (std::size_t i = 0; i < count; ++i) {
    if (hits.hit(static_cast<int>(i))) order_[next[group_of[i]]++] = static_cast<std::uint16_t>(i);
  }
}

void SurfaceGroup::collect(const visibility::RayStream& rays, const visibility::HitStream& hits,
                           std::span<const std::uint16_t> group) {
  points.count = group.size();
  instance = hits.instance[group.front()];
  const std::size_t whole = (group.size() + kWidest - 1) / kWidest * kWidest;
  for (std::size_t k = 0; k < whole; ++k) {
    const std::size_t i = group[std::min(k, group.size() - 1)];
    points.triangle.at[k] = hits.triangle[i];
    points.barycentric.x[k] = hits.u[i], points.barycentric.y[k] = hits.v[i];
    direction.x[k] = rays.dx[i], direction.y[k] = rays.dy[i], direction.z[k] = rays.dz[i];
    t.at[k] = hits.t[i];
  }
}

void SurfaceGroup::shade(const SceneFrame& scene, const Config& config) {
  const std::size_t n = points.count;
  scene.surfaces().at(instance, points, surfaces);
  measure_footprints({direction, t, sample_area}, surfaces, n, footprints);
  scene.materials().bsdf(scene.surfaces().material(instance), surfaces, footprints, n,
                         config.materials, bsdfs);
  shading::make_reflectors(bsdfs, surfaces, footprints.to_eye, n, reflectors);
  offset_origins(surfaces, reflectors.geometric, n, ray_origin);
}

bool shades_in_vectors(const SceneFrame& scene) {
  return scene.triangles().packet_width() > 0;
}

shading::Reflector SurfaceGroup::reflector(std::size_t k) const {
  const shading::Bsdf bsdf{bsdfs.albedo[k], bsdfs.f0[k], bsdfs.f90.at[k], bsdfs.alpha.at[k],
                           bsdfs.lobe};
  return {bsdf, {reflectors.geometric[k], reflectors.shading[k], reflectors.to_eye[k]}};
}

Rgb SurfaceGroup::emission(std::size_t k, const SceneFrame& scene) const {
  const scene::Index material = scene.surfaces().material(instance);
  if (!scene.materials().emits(material)) return Rgb{0.0F};
  if (!(glm::dot(surfaces.geometric[k], footprints.to_eye[k]) > 0.0F)) return Rgb{0.0F};
  return scene.materials().emission(material, surfaces.uv[k], footprints.uv.at[k]);
}

}  // namespace macula::kernels::ray
