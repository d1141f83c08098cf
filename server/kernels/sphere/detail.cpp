#include "server/kernels/sphere/detail.h"

#include <algorithm>
#include <cmath>

namespace macula::kernels::sphere {
namespace {

Plane<float> lightness_of(const Plane<Rgb>& radiance, const image::Tone& tone,
                          TileScheduler& scheduler) {
  Plane<float> lightness(radiance.width(), radiance.height());
  scheduler.run(static_cast<std::size_t>(radiance.height()), [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < radiance.width(); ++x) {
      const Rgb shown = image::display_linear(tone, radiance(x, y));
      lightness(x, y) = std::sqrt(std::max(image::luminance(shown), 0.0F));
    }
  });
  return lightness;
}

/// The most that a block differs from one beside it.
float contrast_at(const Plane<float>& lightness, int x, int y) {
  const float here = lightness(x, y);
  float most = 0.0F;
  if (x > 0) most = std::max(most, std::abs(lightness(x - 1, y) - here));
  if (y > 0) most = std::max(most, std::abs(lightness(x, y - 1) - here));
  if (x + 1 < lightness.width()) most = std::max(most, std::abs(lightness(x + 1, y) - here));
  if (y + 1 < lightness.height()) most = std::max(most, std::abs(lightness(x, y + 1) - here));
  return most;
}

/// Marks the cells of a block that are not important; whether there are any.
bool mark_cells(const Plane<std::uint8_t>& important, int block_x, int block_y,
                Plane<std::uint8_t>& cells) {
  const int x1 = std::min(kMidSide * (block_x + 1), cells.width());
  const int y1 = std::min(kMidSide * (block_y + 1), cells.height());
  bool any = false;
  for (int y = kMidSide * block_y; y < y1; ++y) {
    for (int x = kMidSide * block_x; x < x1; ++x) {
      if (important(x, y) != 0) continue;
      cells(x, y) = 1, any = true;
    }
  }
  return any;
}

}  // namespace

Detail find_detail(const MidLevel& mid, const Plane<std::uint8_t>& important,
                   const image::Tone& tone, float contrast, TileScheduler& scheduler) {
  const Plane<float> lightness = lightness_of(mid.radiance, tone, scheduler);
  Detail detail;
  detail.cells = Plane<std::uint8_t>(important.width(), important.height(), 0);
  detail.blocks = Plane<std::uint8_t>(lightness.width(), lightness.height(), 0);
  scheduler.run(static_cast<std::size_t>(lightness.height()), [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < lightness.width(); ++x) {
      if (!(contrast_at(lightness, x, y) > contrast)) continue;
      if (mark_cells(important, x, y, detail.cells)) detail.blocks(x, y) = 1;
    }
  });
  return detail;
}

}  // namespace macula::kernels::sphere
