#include "server/kernels/ray/post_filter.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/sampling/sample.h"

namespace macula::kernels::ray {
namespace {

constexpr int kFarthest = 32;  ///< cells searched along an axis

/// Remembered, on the same surface, and not resampled itself.
bool is_donor(const MergeJob& job, const Cache& cache, int x, int y, float inverse_depth) {
  if (!job.mask.contains(x, y) || job.mask.reason(x, y) == Reason::Resampled) return false;
  if (!job.mask.traced(x, y) && !cache.remembers(x, y)) return false;
  const float there = job.mask.traced(x, y) ? 1.0F / job.fresh.depth_m(job.fresh.at(x, y))
                                            : cache.inverse_depth(x, y);
  return std::abs(there - inverse_depth) <=
         job.config.merge_threshold * std::max(there, inverse_depth);
}

/// Distance of the nearest donor along the axes, or 0.
int search_distance(const MergeJob& job, const Cache& cache, int x, int y, float inverse_depth) {
  constexpr std::array<std::array<int, 2>, 4> kWays{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
  for (int step = 1; step <= kFarthest; ++step) {
    for (const auto& way : kWays) {
      if (is_donor(job, cache, x + step * way[0], y + step * way[1], inverse_depth)) return step;
    }
  }
  return 0;
}

/// Per unit of reflectance; black where nothing is reflected.
Rgb light_at(const Cache& cache, int x, int y) {
  const Rgb sampled = radiance_of(cache.sampled(x, y)), reflectance = cache.reflectance(x, y).rgb();
  Rgb light{0.0F};
  for (int c = 0; c < 3; ++c) {
    if (reflectance[c] > 0.0F) light[c] = sampled[c] / reflectance[c];
  }
  return light;
}

}  // namespace

Rgb neighbours_light(const MergeJob& job, const Cache& cache, int x, int y) {
  const float inverse_depth = 1.0F / job.fresh.depth_m(job.fresh.at(x, y));
  const int reach = search_distance(job, cache, x, y, inverse_depth);
  const sampling::SampleKey key(0xF117U, job.frame, job.view.grid.cell_key(x, y));
  Rgb light = light_at(cache, x, y);
  if (reach == 0) return light;
  int closest = 2 * (reach + 1) * (reach + 1);
  for (std::uint32_t k = 0; k < static_cast<std::uint32_t>(job.config.post_probes); ++k) {
    const Vec2 u = sampling::sample_2d(key, 2 * k);
    const auto side = static_cast<float>(2 * reach + 1);
    const int dx = static_cast<int>(u.x * side) - reach, dy = static_cast<int>(u.y * side) - reach;
    const int distance = dx * dx + dy * dy;
    if (distance >= closest || !is_donor(job, cache, x + dx, y + dy, inverse_depth)) continue;
    closest = distance;
    light = light_at(cache, x + dx, y + dy);
  }
  return light;
}

}  // namespace macula::kernels::ray
