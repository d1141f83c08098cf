#include "server/lights/light_list.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/lights/light_list_simd.h"
#include "server/sampling/mappings.h"
#include "shared/base/check.h"

namespace macula::lights {
namespace {

/// glTF's spot falloff: a squared ramp in the cosine between the inner and the outer cone.
float spot_falloff(const scene::Light& light, const Vec3& to_light) {
  const double cos_outer = std::cos(light.outer_cone.value());
  const double cos_inner = std::cos(light.inner_cone.value());
  const double cosine = -static_cast<double>(glm::dot(light.direction, to_light));
  if (cosine <= cos_outer) return 0.0F;
  if (cosine >= cos_inner) return 1.0F;
  const double ramp = (cosine - cos_outer) / (cos_inner - cos_outer);
  return static_cast<float>(ramp * ramp);
}

bool is_wanted(scene::StepUse area_lights, bool emits) {
  return area_lights == scene::StepUse::Forced || (area_lights == scene::StepUse::Used && emits);
}

}  // namespace

std::optional<Arrival> arriving(const scene::Light& light, const DVec3& point) {
  if (light.kind == scene::LightKind::Directional) {
    return Arrival{-light.direction, std::numeric_limits<float>::infinity(), light.intensity};
  }
  const DVec3 towards = light.position - point;
  const double distance2 = glm::dot(towards, towards);
  if (!(distance2 > 0.0)) return std::nullopt;
  const double distance = std::sqrt(distance2);
  const Vec3 to_light(towards / distance);
  const float falloff = light.kind == scene::LightKind::Spot ? spot_falloff(light, to_light) : 1.0F;
  if (falloff <= 0.0F) return std::nullopt;
  return Arrival{to_light, static_cast<float>(distance),
                 light.intensity * static_cast<float>(falloff / distance2)};
}

LightList::LightList(const scene::Scene& scene, const shading::MaterialTable& materials,
                     const Options& options)
    : LightList(scene, scene::pose_at(scene, {}), materials, options) {}

LightList::LightList(const scene::Scene& scene, const scene::ScenePose& pose,
                     const shading::MaterialTable& materials, const Options& options)
    : options_(options) {
  if (options_.punctual != scene::StepUse::LeftOut) {
    const std::vector<scene::Light> lights = scene::lights_at(scene, pose);
    punctual_.assign(lights.begin(), lights.end());
  }
  for (scene::Index m = 0; m < scene.materials.size(); ++m) {
    textured_.push_back(materials.textured(m));
  }
  collect_emissive(scene, pose, materials);
}

void LightList::move(const scene::Scene& scene, const scene::MovingParts& moving,
                     const scene::ScenePose& pose, const shading::MaterialTable& materials) {
  if (options_.punctual != scene::StepUse::LeftOut) {
    scene::carry_lights(scene, moving.lights, pose, punctual_);
  }
  const bool relights = std::ranges::any_of(
      moving.instances, [&](scene::Index i) { return shines(scene, i, materials); });
  if (relights) collect_emissive(scene, pose, materials);
}

bool LightList::shines(const scene::Scene& scene, scene::Index instance,
                       const shading::MaterialTable& materials) const {
  const bool emits = materials.emits(scene.meshes[scene.instances[instance].mesh].material);
  return is_wanted(options_.area_lights, emits);
}

void LightList::collect_emissive(const scene::Scene& scene, const scene::ScenePose& pose,
                                 const shading::MaterialTable& materials) {
  table_.reset();
  std::size_t most = 0, count = 0;
  for (scene::Index i = 0; i < scene.instances.size(); ++i) {
    if (!shines(scene, i, materials)) continue;
    const scene::Mesh& mesh = scene.meshes[scene.instances[i].mesh];
    most += mesh.triangles.size();
    if (emissive_.size() < most) emissive_.resize(most);
    count = add_instance(scene, pose, i, materials.mean_emission(mesh.material), count);
  }
  emissive_.resize(count);
  degenerate_ = most - count;
}

std::size_t LightList::add_instance(const scene::Scene& scene, const scene::ScenePose& pose,
                                    scene::Index instance, const Rgb& emission, std::size_t first) {
  const scene::Index mesh_index = scene.instances[instance].mesh;
  const scene::Mesh& mesh = scene.meshes[mesh_index];
  const std::span<const Vec3> positions = pose.positions(scene, mesh_index);
  const DMat4& world_from_object = pose.world_from_object[instance];
  const DMat3 linear(world_from_object);
  // Under a mirroring transform the vertices run the other way round the same front side.
  const double facing = glm::determinant(linear) < 0.0 ? -1.0 : 1.0;
  for (scene::Index t = 0; t < mesh.triangles.size(); ++t) {
    const UVec3 corner = mesh.triangles[t];
    const DVec3 p0(positions[corner.x]);
    const DVec3 e1 = linear * (DVec3(positions[corner.y]) - p0);
    const DVec3 e2 = linear * (DVec3(positions[corner.z]) - p0);
    const DVec3 normal = facing * glm::cross(e1, e2);
    const double twice_area = glm::length(normal);
    const float area = static_cast<float>(0.5 * twice_area);
    if (!(area > 0.0F) || !std::isfinite(area)) continue;
    emissive_[first++] = {linear * p0 + DVec3(world_from_object[3]),
                          Vec3(e1),
                          Vec3(e2),
                          Vec3(normal / twice_area),
                          area,
                          emission,
                          instance,
                          t,
                          mesh.material};
  }
  return first;
}

const EmitterTable& LightList::table() const {
  return table_.get(
      [this](EmitterTable& table) { fill_table(emissive_, options_.selection, textured_, table); });
}

AreaSample LightList::sample_area(const Vec2& u) const {
  MACULA_DCHECK(!emissive_.empty(), "there is no emissive triangle to sample");
  const std::vector<float>& bounds = table().bounds;
  const auto found = std::upper_bound(bounds.begin() + 1, bounds.end() - 1, u.x);
  const auto light = static_cast<std::uint32_t>(found - bounds.begin() - 1);
  const float before = bounds[light], share = table().share(light);
  // The rest of u.x inside its interval is uniform again and chooses along the triangle.
  const float rest = share > 0.0F ? std::clamp((u.x - before) / share, 0.0F, 1.0F) : 0.5F;
  const Vec2 barycentric = sampling::uniform_triangle({rest, u.y});
  const EmissiveTriangle& triangle = emissive_[light];
  const DVec3 position = triangle.position +
                         static_cast<double>(barycentric.x) * DVec3(triangle.edge1) +
                         static_cast<double>(barycentric.y) * DVec3(triangle.edge2);
  return {position, barycentric, pdf_per_m2(light), light};
}

void LightList::arriving_area(const sampling::Vec2Batch& u, const sampling::Vec3Batch& points,
                              std::size_t count, const shading::SurfaceTable& surfaces,
                              const shading::MaterialTable& materials,
                              AreaArrivalBatch& out) const {
  MACULA_DCHECK(!emissive_.empty() && count <= sampling::kBatch);
  const EmitterTable& drawn = table();
  arriving_from_table(drawn, u, points, count, out);
  if (!drawn.any_textured) return;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t light = out.light.at[i];
    if (drawn.textured[light] == 0) continue;
    const Rgb tint = emission(light, out.barycentric[i], surfaces, materials);
    out.arrival.irradiance.set(i, tint * out.arrival.irradiance[i]);
  }
}

float LightList::pdf_per_m2(std::uint32_t light) const {
  return table().share(light) / emissive_[light].area_m2;
}

Rgb LightList::emission(std::uint32_t light, const Vec2& barycentric,
                        const shading::SurfaceTable& surfaces,
                        const shading::MaterialTable& materials) const {
  const EmissiveTriangle& triangle = emissive_[light];
  if (!materials.textured(triangle.material)) return triangle.mean_emission;
  const shading::Surface surface = surfaces.at(triangle.instance, triangle.triangle, barycentric);
  return materials.lamp_emission(triangle.material, surface.uv);
}

}  // namespace macula::lights
