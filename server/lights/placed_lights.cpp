#include "server/lights/placed_lights.h"

#include <cmath>

#include "server/lights/placed_lights_simd.h"
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

void write(const Vec3& v, float* to) {
  to[0] = v.x, to[1] = v.y, to[2] = v.z;
}

void write_row(const scene::Light& light, float* row) {
  write(Vec3(light.position), row);
  write(cone_cosines(light), row + 3);
  write(Vec3{0.0F}, row + 6);
  write(light.direction, row + 9);
  write(Vec3(light.intensity), row + 12);
  row[15] = 0.0F;
}

void write_row(const EmissiveTriangle& light, float* row) {
  write(Vec3(light.position), row);
  write(light.edge1, row + 3);
  write(light.edge2, row + 6);
  write(light.normal, row + 9);
  write(Vec3(light.mean_emission), row + 12);
  row[15] = light.area_m2;
}

}  // namespace

void PlacedLights::resize(std::size_t count) {
  bounds_.resize(count);
  table_.rows.resize(PlacedLightTable::kRowFloats * count);
  table_.triangle.resize(count);
}

void PlacedLights::make(const LightList& list) {
  const auto punctual = list.punctual();
  const auto emissive = list.emissive();
  resize(punctual.size() + emissive.size());
  apart_.clear();
  std::size_t count = 0;
  const auto add = [&](const auto& light, std::uint32_t triangle) {
    if (!write_bounds(light, bounds_[count])) return false;
    write_row(light, table_.rows.data() + PlacedLightTable::kRowFloats * count);
    table_.triangle[count++] = triangle;
    return true;
  };
  for (const scene::Light& light : punctual) {
    if (!add(light, 0) && !is_black(light.intensity)) apart_.push_back(light);
  }
  for (std::uint32_t i = 0; i < emissive.size(); ++i) add(emissive[i], i + 1);
  resize(count);
  tree_.build(bounds_);
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
