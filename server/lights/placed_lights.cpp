#include "server/lights/placed_lights.h"

#include <cmath>

#include "server/lights/placed_lights_simd.h"
#include "shared/base/check.h"

namespace macula::lights {
namespace {

bool is_black(const Rgb& c) {
  return c.x == 0.0F && c.y == 0.0F && c.z == 0.0F;
}

void append(std::vector<float>& row, const Vec3& v) {
  row.insert(row.end(), {v.x, v.y, v.z});
}

/// A point shines as a cone without an edge.
Vec3 cone_cosines(const scene::Light& light) {
  if (light.kind != scene::LightKind::Spot) return {-2.0F, -1.5F, 0.0F};
  return {static_cast<float>(std::cos(light.outer_cone.value())),
          static_cast<float>(std::cos(light.inner_cone.value())), 0.0F};
}

void append_row(const scene::Light& light, PlacedLightTable& table) {
  for (const Vec3& v : {Vec3(light.position), cone_cosines(light), Vec3{0.0F}, light.direction,
                        Vec3(light.intensity)}) {
    append(table.rows, v);
  }
  table.rows.push_back(0.0F);
  table.triangle.push_back(0);
}

void append_row(const EmissiveTriangle& light, std::uint32_t index, PlacedLightTable& table) {
  for (const Vec3& v :
       {Vec3(light.position), light.edge1, light.edge2, light.normal, Vec3(light.mean_emission)}) {
    append(table.rows, v);
  }
  table.rows.push_back(light.area_m2);
  table.triangle.push_back(index + 1);
}

}  // namespace

PlacedLights::PlacedLights(const LightList& list) {
  for (const scene::Light& light : list.punctual()) {
    if (const auto bounds = bounds_of(light)) {
      bounds_.push_back(*bounds);
      append_row(light, table_);
    } else if (!is_black(light.intensity)) {
      apart_.push_back(light);
    }
  }
  const auto emissive = list.emissive();
  for (std::uint32_t i = 0; i < emissive.size(); ++i) {
    if (const auto bounds = bounds_of(emissive[i])) {
      bounds_.push_back(*bounds);
      append_row(emissive[i], i, table_);
    }
  }
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
