#include "server/lights/emitter_table.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "server/lights/light_list.h"

namespace macula::lights {
namespace {

double weight(const EmissiveTriangle& light, Selection selection) {
  switch (selection) {
    case Selection::ByPower:
      return light.area_m2 * image::luminance(light.mean_emission);
    case Selection::ByArea:
      return light.area_m2;
    case Selection::Alike:
      return 1.0;
  }
  return 0.0;
}

/// Ends at exactly 1 and never falls. All weights zero (black textures): all alike.
void add_shares(std::span<const EmissiveTriangle> lights, Selection selection,
                std::vector<float>& bounds) {
  double total = 0.0;
  for (const EmissiveTriangle& light : lights) total += weight(light, selection);
  const bool dark = !(total > 0.0) || !std::isfinite(total);
  bounds.push_back(0.0F);
  double sum = 0.0;
  for (const EmissiveTriangle& light : lights) {
    sum += dark ? 1.0 / static_cast<double>(lights.size()) : weight(light, selection) / total;
    bounds.push_back(static_cast<float>(std::min(sum, 1.0)));
  }
  bounds.back() = 1.0F;
}

/// A guide entry for every kEntriesPerLight-th of a light on average: fewer than two further steps.
void add_guide(const std::vector<float>& bounds, std::vector<std::int32_t>& guide) {
  constexpr std::size_t kEntriesPerLight = 2;
  const std::size_t lights = bounds.size() - 1;
  guide.resize(std::bit_ceil(kEntriesPerLight * lights));
  std::size_t light = 0;
  for (std::size_t k = 0; k < guide.size(); ++k) {
    const float u = static_cast<float>(k) / static_cast<float>(guide.size());
    while (light + 1 < lights && bounds[light + 1] <= u) ++light;
    guide[k] = static_cast<std::int32_t>(light);
  }
}

float* append(float* row, const Vec3& v) {
  row[0] = v.x, row[1] = v.y, row[2] = v.z;
  return row + 3;
}

}  // namespace

void fill_table(std::span<const EmissiveTriangle> lights, Selection selection,
                const std::vector<bool>& textured, EmitterTable& table) {
  table.rows.resize(EmitterTable::kRowFloats * lights.size());
  table.textured.resize(lights.size());
  table.any_textured = false;
  float* row = table.rows.data();
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const EmissiveTriangle& light = lights[i];
    const bool from_texture = textured[light.material];
    row = append(row, Vec3(light.position));
    row = append(row, light.edge1);
    row = append(row, light.edge2);
    row = append(row, light.normal);
    row = append(row, from_texture ? Rgb{1.0F} : light.mean_emission);
    *row++ = light.area_m2;
    table.textured[i] = from_texture ? 1U : 0U;
    table.any_textured = table.any_textured || from_texture;
  }
  table.bounds.clear(), table.guide.clear();
  if (lights.empty()) return;
  add_shares(lights, selection, table.bounds);
  add_guide(table.bounds, table.guide);
}

}  // namespace macula::lights
