#include "server/shading/surface.h"

#include <algorithm>
#include <cmath>

#include "shared/base/check.h"

namespace macula::shading {
namespace {

Vec3 unit_or_zero(const Vec3& v) {
  const float length = glm::length(v);
  return length > 0.0F ? v / length : Vec3{0.0F};
}

float largest_coordinate(const Vec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// The largest sum of a row's absolute values: the norm that goes with the largest coordinate.
float row_sum_norm(const DMat3& m) {
  const DVec3 sums = glm::abs(m[0]) + glm::abs(m[1]) + glm::abs(m[2]);
  return static_cast<float>(std::max({sums.x, sums.y, sums.z}));
}

std::vector<float> uv_densities(const scene::Mesh& mesh) {
  if (mesh.texcoords.empty()) return {};
  std::vector<float> densities;
  densities.reserve(mesh.triangles.size());
  for (const UVec3& t : mesh.triangles) {
    const Vec3 e1 = mesh.positions[t.y] - mesh.positions[t.x];
    const Vec3 e2 = mesh.positions[t.z] - mesh.positions[t.x];
    const Vec2 d1 = mesh.texcoords[t.y] - mesh.texcoords[t.x];
    const Vec2 d2 = mesh.texcoords[t.z] - mesh.texcoords[t.x];
    const float area = glm::length(glm::cross(e1, e2));
    const float uv_area = std::abs(d1.x * d2.y - d1.y * d2.x);
    densities.push_back(area > 0.0F ? std::sqrt(uv_area / area) : 0.0F);
  }
  return densities;
}

}  // namespace

SurfaceTable::SurfaceTable(const scene::Scene& scene)
    : SurfaceTable(scene, scene::pose_at(scene, {})) {
  MACULA_CHECK(scene::moving_parts(scene).meshes.empty(), "shapes lie in a pose, which must last");
}

SurfaceTable::SurfaceTable(const scene::Scene& scene, const scene::ScenePose& pose) {
  auto densities = std::make_shared<Densities>();
  densities->reserve(scene.meshes.size());
  for (const scene::Mesh& mesh : scene.meshes) densities->push_back(uv_densities(mesh));
  uv_per_unit_ = std::move(densities);
  instances_.reserve(scene.instances.size());
  for (scene::Index i = 0; i < scene.instances.size(); ++i)
    instances_.push_back(place(scene, i, pose, *uv_per_unit_));
}

SurfaceTable::Placed SurfaceTable::place(const scene::Scene& scene, scene::Index instance,
                                         const scene::ScenePose& pose, const Densities& densities) {
  const scene::Index mesh = scene.instances[instance].mesh;
  const DMat4& world_from_object = pose.world_from_object[instance];
  const DMat3 linear(world_from_object);
  return {&scene.meshes[mesh],
          pose.positions(scene, mesh),
          pose.normals(scene, mesh),
          &densities[mesh],
          linear,
          DVec3(world_from_object[3]),
          Mat3(glm::inverseTranspose(linear)),
          static_cast<float>(std::cbrt(std::abs(glm::determinant(linear)))),
          row_sum_norm(linear),
          scene.meshes[mesh].material};
}

void SurfaceTable::move(const scene::Scene& scene, std::span<const scene::Index> instances,
                        const scene::ScenePose& pose) {
  for (const scene::Index i : instances) instances_[i] = place(scene, i, pose, *uv_per_unit_);
}

Surface SurfaceTable::at(scene::Index instance, scene::Index triangle,
                         const Vec2& barycentric) const {
  const Placed& placed = instances_[instance];
  const scene::Mesh& mesh = *placed.mesh;
  const UVec3 t = mesh.triangles[triangle];
  const float u = barycentric.x, v = barycentric.y, w = 1.0F - u - v;
  const Vec3 p0 = placed.positions[t.x];
  const Vec3 e1 = placed.positions[t.y] - p0, e2 = placed.positions[t.z] - p0;
  Surface surface;
  const DVec3 local =
      DVec3(p0) + static_cast<double>(u) * DVec3(e1) + static_cast<double>(v) * DVec3(e2);
  surface.position = placed.world_from_object * local + placed.translation;
  surface.geometric_normal = unit_or_zero(placed.normal_from_object * glm::cross(e1, e2));
  surface.shading_normal = surface.geometric_normal;
  if (!placed.normals.empty()) {
    const std::span<const Vec3> normals = placed.normals;
    const Vec3 blended = w * normals[t.x] + u * normals[t.y] + v * normals[t.z];
    const Vec3 normal = unit_or_zero(placed.normal_from_object * blended);
    if (normal != Vec3{0.0F}) surface.shading_normal = normal;
  }
  if (!mesh.texcoords.empty()) {
    surface.uv = w * mesh.texcoords[t.x] + u * mesh.texcoords[t.y] + v * mesh.texcoords[t.z];
  }
  surface.material = placed.material;
  const float edge = std::max(largest_coordinate(e1), largest_coordinate(e2));
  surface.span_m = std::max(placed.stretch * edge, largest_coordinate(Vec3(placed.translation)));
  return surface;
}

void SurfaceTable::fetch_triangle(scene::Index instance, scene::Index triangle) const {
  const Placed& placed = instances_[instance];
  __builtin_prefetch(&placed.mesh->triangles[triangle]);
  if (!placed.uv_per_unit->empty()) __builtin_prefetch(&(*placed.uv_per_unit)[triangle]);
}

void SurfaceTable::fetch_vertices(scene::Index instance, scene::Index triangle) const {
  const Placed& placed = instances_[instance];
  const UVec3 t = placed.mesh->triangles[triangle];
  for (const scene::Index vertex : {t.x, t.y, t.z}) {
    __builtin_prefetch(&placed.positions[vertex]);
    if (!placed.normals.empty()) __builtin_prefetch(&placed.normals[vertex]);
    if (!placed.mesh->texcoords.empty()) __builtin_prefetch(&placed.mesh->texcoords[vertex]);
  }
}

float SurfaceTable::uv_per_meter(scene::Index instance, scene::Index triangle) const {
  const Placed& placed = instances_[instance];
  if (placed.uv_per_unit->empty() || !(placed.meters_per_unit > 0.0F)) return 0.0F;
  return (*placed.uv_per_unit)[triangle] / placed.meters_per_unit;
}

}  // namespace macula::shading
