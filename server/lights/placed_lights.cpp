#include "server/lights/placed_lights.h"

#include <cmath>
#include <numbers>

#include "server/lights/placed_lights_simd.h"
#include "server/lights/table_writer.h"
#include "shared/base/check.h"

namespace macula::lights {
namespace {

bool is_black(const Rgb& c) {
  return c.x == 0.0F && c.y == 0.0F && c.z == 0.0F;
}

/// A point shines as a cone without an edge.
Vec3 cone_cosines(const scene::Light& light) {
  if (light.kind != scene::LightKind::Spot) return {-2.0F, -1.5F, 0.0F};
  return {static_cast<float>(std::cos(light.outer_cone.value())),
          static_cast<float>(std::cos(light.inner_cone.value())), 0.0F};
}

/// Of a light that a tree can weigh: one without light, or with more than a float holds, is not.
bool is_usable(float intensity, const DVec3& position) {
  return intensity > 0.0F && std::isfinite(intensity) && math::is_finite(position);
}

bool write_row(const scene::Light& light, PlacedLightRow& row) {
  if (light.kind == scene::LightKind::Directional ||
      !is_usable(image::luminance(light.intensity), light.position)) {
    return false;
  }
  row.position = Vec3(light.position);
  row.edge1 = cone_cosines(light);
  row.edge2 = Vec3{0.0F};
  row.normal = light.direction;
  row.emission = light.intensity;
  row.area = 0.0F;
  return true;
}

bool write_row(const EmissiveTriangle& light, PlacedLightRow& row) {
  if (!is_usable(light.area_m2 * image::luminance(light.mean_emission), light.position)) {
    return false;
  }
  row.position = Vec3(light.position);
  row.edge1 = light.edge1;
  row.edge2 = light.edge2;
  row.normal = light.normal;
  row.emission = light.mean_emission;
  row.area = light.area_m2;
  return true;
}

bool write_row(const VirtualPointLight& light, PlacedLightRow& row) {
  const Vec3 intensity = light.flux / std::numbers::pi_v<float>;
  if (!is_usable(image::luminance(intensity), light.position)) return false;
  row.position = Vec3(light.position);
  row.edge1 = {light.span_m, 0.0F, 0.0F};
  row.edge2 = Vec3{0.0F};
  row.normal = light.normal;
  row.emission = intensity;
  row.area = PlacedLightRow::kVirtual;
  return true;
}

/// lights[i]; those to come are on their way.
template <class Light>
const Light& asked_ahead(std::span<const Light> lights, std::size_t i) {
  constexpr std::size_t kAhead = 16;
  if (i + kAhead < lights.size()) __builtin_prefetch(&lights[i + kAhead]);
  return lights[i];
}

}  // namespace

void PlacedLights::make(const LightList& list, std::span<const VirtualPointLight> virtual_lights) {
  const auto punctual = list.punctual();
  const auto emissive = list.emissive();
  TableWriter writer(table_, punctual.size() + emissive.size() + virtual_lights.size());
  apart_.clear();
  for (std::size_t i = 0; i < punctual.size(); ++i) {
    if (write_row(asked_ahead(punctual, i), writer.next())) {
      writer.keep(0);
    } else if (!is_black(punctual[i].intensity)) {
      apart_.push_back(punctual[i]);
    }
  }
  for (std::uint32_t i = 0; i < emissive.size(); ++i) {
    if (write_row(asked_ahead(emissive, i), writer.next())) writer.keep(i + 1);
  }
  first_virtual_ = writer.size();
  for (const VirtualPointLight& light : virtual_lights) {
    if (write_row(light, writer.next())) writer.keep(0);
  }
  writer.finish();
  tree_.build(table_);
}

void PlacedLights::arriving(const LightDraws& draws, const sampling::Vec2Batch& u,
                            const sampling::Vec3Batch& points, std::size_t count,
                            const LightList& list, const shading::SurfaceTable& surfaces,
                            const shading::MaterialTable& materials, AreaArrivalBatch& out) const {
  MACULA_DCHECK(size() > 0 && count <= sampling::kBatch);
  arriving_from_placed(table_, draws, u, points, count, out);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t triangle = table_.triangle[out.light.at[i]];
    if (triangle == 0 || out.arrival.irradiance[i] == Rgb{0.0F}) continue;
    const EmissiveTriangle& light = list.emissive()[triangle - 1];
    if (!materials.textured(light.material)) continue;
    // The row has the mean; here the light is what the texture says at this very point.
    const Rgb there = list.emission(triangle - 1, out.barycentric[i], surfaces, materials);
    const Rgb mean = light.mean_emission, arrives = out.arrival.irradiance[i];
    const auto scaled = [](float value, float actual, float average) {
      return average > 0.0F ? value * (actual / average) : 0.0F;
    };
    out.arrival.irradiance.set(
        i, {scaled(arrives.x, there.x, mean.x), scaled(arrives.y, there.y, mean.y),
            scaled(arrives.z, there.z, mean.z)});
  }
}

}  // namespace macula::lights
