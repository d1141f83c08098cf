#include "server/kernels/ray/merge.h"

#include <algorithm>
#include <cmath>

#include "server/kernels/ray/post_filter.h"
#include "server/reconstruction/history_rows.h"

namespace macula::kernels::ray {
namespace {

/// Bilinear between the support cells, whose own cache is up to date.
template <class T, class Fetch>
T between_support(const Support& support, int x, int y, const Fetch& fetch) {
  const int left = support.x.cells[support.x.left[x]], right = support.x.cells[support.x.right(x)];
  const int top = support.y.cells[support.y.left[y]], bottom = support.y.cells[support.y.right(y)];
  const float across = std::clamp(support.x.fraction[x], 0.0F, 1.0F);
  const float down = std::clamp(support.y.fraction[y], 0.0F, 1.0F);
  const T upper = (1.0F - across) * fetch(left, top) + across * fetch(right, top);
  const T lower = (1.0F - across) * fetch(left, bottom) + across * fetch(right, bottom);
  return (1.0F - down) * upper + down * lower;
}

int nearest(const SupportAxis& axis, int cell) {
  return axis.cells[axis.fraction[cell] < 0.5F ? axis.left[cell] : axis.right(cell)];
}

void fill_cell(const Support& support, int x, int y, Cache& cache) {
  cache.info(x, y) = CacheInfo{};
  const auto of = [&](const Plane<Texel>& plane) {
    return Texel(
        between_support<Rgb>(support, x, y, [&](int i, int j) { return plane(i, j).rgb(); }));
  };
  cache.color(x, y) = of(cache.color);
  if (cache.has_light()) {
    cache.sampled(x, y) = of(cache.sampled);
    cache.reflectance(x, y) = of(cache.reflectance);
  }
  const int near_x = nearest(support.x, x), near_y = nearest(support.y, y);
  if (!cache.surface_id.empty()) cache.surface_id(x, y) = cache.surface_id(near_x, near_y);
  if (!cache.normal.empty()) cache.normal(x, y) = cache.normal(near_x, near_y);
  if (!cache.albedo.empty()) cache.albedo(x, y) = cache.albedo(near_x, near_y);
}

/// Of the support's samples, at one cell.
float depth_between(const Support& support, int x, int y) {
  const int i = support.x.left[x], k = support.x.right(x);
  const int j = support.y.left[y], l = support.y.right(y);
  const float across = support.x.fraction[x], down = support.y.fraction[y];
  const auto mix = [](float a, float b, float t) { return a + t * (b - a); };
  const float upper = mix(support.inverse_depth(i, j), support.inverse_depth(k, j), across);
  const float lower = mix(support.inverse_depth(i, l), support.inverse_depth(k, l), across);
  return 1.0F / std::max(mix(upper, lower, down), 0.0F);
}

}  // namespace

void finish_cell(const MergeJob& job, int x, int y, Cache& cache, Plane<float>& depth_m) {
  const float depth = job.fresh.depth_m(job.fresh.at(x, y));
  depth_m(x, y) = depth;
  cache.inverse_depth(x, y) = inverse_of(depth);
}

void finish_cells(const MergeJob& job, std::span<const image::Pixel> cells, Cache& cache,
                  Plane<float>& depth_m) {
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i + kAhead < cells.size()) {
      const image::Pixel& next = cells[i + kAhead];
      __builtin_prefetch(&depth_m(next.x, next.y));
      __builtin_prefetch(&cache.inverse_depth(next.x, next.y));
    }
    finish_cell(job, cells[i].x, cells[i].y, cache, depth_m);
  }
}

void fill_cells(const MergeJob& job, std::span<const image::Pixel> cells, Cache& cache,
                ViewBuffers& out) {
  for (const auto& [x, y] : cells) {
    fill_cell(job.support, x, y, cache);
    out.radiance(x, y) = cache.shown(x, y);
    out.depth_m(x, y) = depth_between(job.support, x, y);
  }
}

void post_filter_cells(const MergeJob& job, std::span<const image::Pixel> cells, const Cache& cache,
                       Plane<Rgb>& radiance) {
  if (!cache.has_light()) return;
  for (const auto& [x, y] : cells) {
    radiance(x, y) = radiance_of(cache.color(x, y)) +
                     cache.reflectance(x, y).rgb() * neighbours_light(job, cache, x, y);
  }
}

void show_row(const Cache& cache, int y, ViewBuffers& out) {
  const std::span<const Texel> sampled =
      cache.has_light() ? cache.sampled.row(y) : std::span<const Texel>{};
  reconstruction::show_row(cache.color.row(y), sampled, out.radiance.row(y));
  const std::span<const float> remembered = cache.inverse_depth.row(y);
  const std::span<float> depth = out.depth_m.row(y);
  for (std::size_t x = 0; x < depth.size(); ++x) depth[x] = 1.0F / remembered[x];
}

void copy_rows(const Cache& cache, int first, int last, ViewBuffers& out) {
  for (int y = first; y < last; ++y) {
    if (!out.surface_id.empty())
      std::ranges::copy(cache.surface_id.row(y), out.surface_id.row(y).begin());
    if (!out.normal.empty()) std::ranges::copy(cache.normal.row(y), out.normal.row(y).begin());
    if (!out.albedo.empty()) std::ranges::copy(cache.albedo.row(y), out.albedo.row(y).begin());
    if (!out.variance.empty()) std::ranges::fill(out.variance.row(y), INFINITY);
    if (out.samples.empty()) continue;
    for (int x = 0; x < cache.info.width(); ++x) out.samples(x, y) = cache.info(x, y).samples;
  }
}

}  // namespace macula::kernels::ray
