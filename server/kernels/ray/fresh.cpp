#include "server/kernels/ray/fresh.h"

#include <algorithm>

#include "server/kernels/planes.h"

namespace macula::kernels::ray {

void FreshSamples::prepare(int width, int height, unsigned wanted, std::size_t cells) {
  constexpr int kWidth = static_cast<int>(kBatch);
  // Two lists leave two batches that are not full; vectors reach beyond the last sample.
  const int needed = static_cast<int>(cells / kBatch) + 3;
  if (chroma_.height() < needed || wanted != wanted_) {
    const int rows = std::max(needed + needed / 4, chroma_.height());
    prepare_planes(planes_, wanted, kWidth, rows);
    chroma_.resize(kWidth, rows);
    wanted_ = wanted;
  }
  if (places_.width() != width || places_.height() != height) places_.resize(width, height);
  rows_ = 0;
}

void FreshSamples::add_chroma(int row, std::size_t cells) {
  const std::size_t first = static_cast<std::size_t>(row) * kBatch;
  for (std::size_t at = first; at < first + cells; ++at) {
    const Rgb c = color(at);
    chroma_.data()[at] =
        reconstruction::Texel({0.25F * c.x + 0.5F * c.y + 0.25F * c.z, 0.5F * c.x - 0.5F * c.z,
                               -0.25F * c.x + 0.5F * c.y - 0.25F * c.z});
  }
}

/// Radiance without the light that chance estimates.
Rgb FreshSamples::color(std::size_t at) const {
  if (planes_.light.empty()) return glm::max(radiance(at), Rgb{0.0F});
  return glm::max(radiance(at) - light(at) * reflectance(at), Rgb{0.0F});
}

int FreshSamples::place(std::span<const image::Pixel> cells) {
  const int first = rows_;
  auto next = static_cast<std::uint32_t>(static_cast<std::size_t>(first) * kBatch);
  for (const auto& [x, y] : cells) places_(x, y) = next++;
  rows_ += static_cast<int>(batch_count(cells.size()));
  MACULA_CHECK(rows_ <= chroma_.height());
  return first;
}

}  // namespace macula::kernels::ray
