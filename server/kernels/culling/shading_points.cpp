#include "server/kernels/culling/shading_points.h"

#include <algorithm>
#include <bit>

#include "shared/base/check.h"

namespace macula::kernels::culling {
namespace {

using image::Pixel;

/// Every second bit of a Morton number.
int half_bits(std::uint32_t bits) {
  bits &= 0x5555'5555U;
  bits = (bits | (bits >> 1)) & 0x3333'3333U;
  bits = (bits | (bits >> 2)) & 0x0F0F'0F0FU;
  bits = (bits | (bits >> 4)) & 0x00FF'00FFU;
  return static_cast<int>((bits | (bits >> 8)) & 0x0000'FFFFU);
}

/// Calls each(Pixel) for the cells of a plane in Morton order.
template <class Each>
void along_morton_curve(const image::Plane<float>& plane, Each each) {
  const auto longest = static_cast<std::uint32_t>(std::max(plane.width(), plane.height()));
  const std::uint64_t side = std::bit_ceil(longest);
  for (std::uint64_t code = 0; code < side * side; ++code) {
    const auto bits = static_cast<std::uint32_t>(code);
    const Pixel cell{half_bits(bits), half_bits(bits >> 1)};
    if (plane.contains(cell.x, cell.y)) each(cell);
  }
}

double total(const image::Plane<float>& plane) {
  double sum = 0.0;
  for (const float value : plane.pixels()) sum += value;
  return sum;
}

}  // namespace

std::vector<Pixel> draw_systematically(const image::Plane<float>& importance, int count, float u) {
  MACULA_CHECK(count >= 0);
  std::vector<Pixel> points;
  const double step = total(importance) / count;
  if (!(step > 0.0)) return points;
  double passed = 0.0, next = static_cast<double>(u) * step;
  along_morton_curve(importance, [&](const Pixel& cell) {
    passed += importance(cell.x, cell.y);
    for (; next < passed && points.size() < static_cast<std::size_t>(count); next += step)
      points.push_back(cell);
  });
  return points;
}

std::vector<Pixel> draw_by_chains(const image::Plane<float>& importance, int count, int chain,
                                  sampling::SampleKey key) {
  std::vector<Pixel> points;
  for (int k = 0; k < count; ++k) {
    Pixel best;
    float most = 0.0F;
    for (int i = 0; i < chain; ++i) {
      const Vec2 at = sampling::sample_2d(key, 2 * static_cast<std::uint32_t>(k * chain + i));
      const Pixel cell{static_cast<int>(at.x * static_cast<float>(importance.width())),
                       static_cast<int>(at.y * static_cast<float>(importance.height()))};
      if (importance(cell.x, cell.y) > most) most = importance(cell.x, cell.y), best = cell;
    }
    if (most > 0.0F) points.push_back(best);
  }
  return points;
}

}  // namespace macula::kernels::culling
