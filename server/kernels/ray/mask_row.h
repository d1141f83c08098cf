// One row of the sampling mask, in vectors: probabilities, and which cells' thresholds lie below
// theirs. Internal to the mask.
#pragma once

#include <cstdint>
#include <span>

#include "shared/math/vec.h"

namespace macula::kernels::ray {

/// What the probability of a row's cells depends on. Spans over columns have one length.
struct ProbabilityRow {
  Vec3 gaze{0.0F, 0.0F, -1.0F};       ///< unit, view space
  float tangent_y = 0.0F;             ///< of the row's centre
  std::span<const float> tangent_x;   ///< of the columns' centres
  std::span<const float> cell_width;  ///< on the tangent plane
  /// Nominal pixels in a cell as wide as 1: the row's height in them.
  float area_per_width = 1.0F;
  /// Rates over sin(e / 2): of s = i / (rates.size() - 1) at i.
  std::span<const float> rates;
};

/// min(1, rate x area in nominal pixels) of every cell.
void probabilities(const ProbabilityRow& row, std::span<float> out);

/// out[x] = 2 where p[x] >= 1, else 1 where the threshold of the blue noise rank ranks[x mod 64],
/// moved on by `level` / 2^32, lies below p[x], else 0. Returns how many are not 0.
std::size_t compare_thresholds(std::span<const float> p, std::span<const std::uint16_t> ranks,
                               std::uint32_t level, std::span<std::uint8_t> out);

}  // namespace macula::kernels::ray
