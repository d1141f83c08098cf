// EmitterTable: emissive triangles to be drawn one at a time, as vectors gather them: 16 floats a
// triangle, and a guide into the cumulative shares (cut-point method, Chen and Asau 1974).
// Internal to the room.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/shading/material_table.h"

namespace macula::lights {

struct EmissiveTriangle;
enum class Selection;

struct EmitterTable {
  static constexpr std::size_t kRowFloats = 16;
  std::vector<float> rows;          ///< position, edge1, edge2, normal, emission, area
  std::vector<float> bounds;        ///< 0, then the chance of a triangle <= i; ends at exactly 1
  std::vector<std::int32_t> guide;  ///< first triangle that u in [k, k + 1) / size may choose
  std::vector<std::uint32_t> textured;  ///< 1 where the emission comes from a texture, row has 1
  bool any_textured = false;

  float share(std::size_t light) const { return bounds[light + 1] - bounds[light]; }
};

/// Keeps the table's memory. `textured` by material.
void fill_table(std::span<const EmissiveTriangle> lights, Selection selection,
                const std::vector<bool>& textured, EmitterTable& table);

}  // namespace macula::lights
