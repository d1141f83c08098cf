#include "server/lights/virtual_light_table.h"

#include <algorithm>
#include <numbers>

#include "shared/base/check.h"
#include "shared/image/color.h"

namespace macula::lights {
namespace {

/// Lanes of the widest vectors.
constexpr std::size_t kLanes = 16;

}  // namespace

VirtualLightTable::VirtualLightTable(std::span<const VirtualPointLight> lights, int classes,
                                     float least_m)
    : count_(lights.size()), classes_(classes), least_m_(least_m) {
  MACULA_CHECK(classes >= 1 && least_m >= 0.0F);
  if (empty()) return;
  const std::size_t largest = (count_ - 1) / static_cast<std::size_t>(classes) + 1;
  rounds_ = (largest + kLanes - 1) / kLanes * kLanes;
  const std::size_t rows = rounds_ * static_cast<std::size_t>(classes);
  rows_.resize(rows * kRowFloats);
  columns_.resize(rows * kColumns);
  for (std::size_t i = 0; i < count_; ++i) set(row_of(i), lights[i]);
}

void VirtualLightTable::set(std::size_t row, const VirtualPointLight& light) {
  const Vec3 position(light.position);
  const Rgb strength = light.flux / std::numbers::pi_v<float>;
  const float least_m = std::min(least_m_, light.footprint_m);
  const float values[] = {position.x,     position.y,     position.z,       light.normal.x,
                          light.normal.y, light.normal.z, strength.x,       strength.y,
                          strength.z,     light.span_m,   least_m * least_m};
  std::copy(std::begin(values), std::end(values), rows_.begin() + row * kRowFloats);
  const std::size_t rows = columns_.size() / kColumns;
  for (std::size_t c = 0; c < 6; ++c) columns_[c * rows + row] = values[c];
  columns_[6 * rows + row] = image::luminance(strength);
  columns_[7 * rows + row] = least_m * least_m;
}

}  // namespace macula::lights
