#include "server/kernels/ray/support.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

namespace macula::kernels::ray {
namespace {

float centre(const std::vector<float>& edges, int cell) {
  return 0.5F * (edges[cell] + edges[cell + 1]);
}

/// How far sample i lies off the line through its neighbours, relative to itself.
float bend(float before, float here, float after) {
  const float largest = std::max({before, here, after});
  return largest > 0.0F ? std::abs(before - 2.0F * here + after) / largest : 0.0F;
}

/// A step lies between samples b and c of a, b, c, d where both bend; at a crease only one does. At
/// the picture's border, where a or d is missing, the other end decides.
bool is_step(const std::array<float, 4>& w, bool has_before, bool has_after, float threshold) {
  const bool bends_before = !has_before || bend(w[0], w[1], w[2]) > threshold;
  const bool bends_after = !has_after || bend(w[1], w[2], w[3]) > threshold;
  const float largest = std::max(w[1], w[2]);
  const bool differs = std::abs(w[1] - w[2]) > threshold * largest;
  return differs && bends_before && bends_after && (has_before || has_after);
}

}  // namespace

SupportAxis::SupportAxis(const std::vector<float>& edges, float spacing) {
  const int size = static_cast<int>(edges.size()) - 1;
  const int samples =
      std::clamp(static_cast<int>(std::ceil(static_cast<float>(size) / spacing)), 1, size);
  chosen.resize(size, 0);
  for (int i = 0; i < samples; ++i) {
    const std::int64_t twice = (2 * static_cast<std::int64_t>(i) + 1) * size;
    cells.push_back(static_cast<int>(twice / (2 * samples)));
    chosen[cells.back()] = 1;
  }
  int sample = 0;
  for (int cell = 0; cell < size; ++cell) {
    while (sample + 2 < samples && cells[sample + 1] <= cell) ++sample;
    left.push_back(sample);
    const int next = std::min(sample + 1, samples - 1);
    const float from = centre(edges, cells[sample]), to = centre(edges, cells[next]);
    fraction.push_back(to > from ? (centre(edges, cell) - from) / (to - from) : 0.0F);
  }
}

Support::Support(const PixelGrid& grid, float spacing)
    : x(grid.x_edges, spacing),
      y(grid.y_edges, spacing),
      inverse_depth(x.count(), y.count()),
      normal(x.count(), y.count()),
      broken(std::max(x.count() - 1, 1), std::max(y.count() - 1, 1)) {}

void Support::fill(const FreshSamples& fresh, const FoveatedConfig& config) {
  for (int j = 0; j < y.count(); ++j) {
    for (int i = 0; i < x.count(); ++i) {
      const std::size_t at = fresh.at(x.cells[i], y.cells[j]);
      inverse_depth(i, j) = inverse_of(fresh.depth_m(at));
      normal(i, j) = fresh.normal(at);
    }
  }
  find_broken(config.depth_threshold);
}

void Support::find_broken(float threshold) {
  std::ranges::fill(broken.pixels(), std::uint8_t{0});
  const auto step = [&](int i, int j, int dx, int dy) {
    const auto at = [&](int k) {
      return inverse_depth(std::clamp(i + k * dx, 0, x.count() - 1),
                           std::clamp(j + k * dy, 0, y.count() - 1));
    };
    const bool before = i - dx >= 0 && j - dy >= 0;
    const bool after = i + 2 * dx < x.count() && j + 2 * dy < y.count();
    return is_step({at(-1), at(0), at(1), at(2)}, before, after, threshold);
  };
  const auto mark = [&](int i, int j) {
    if (broken.contains(i, j)) broken(i, j) = 1;
  };
  for (int j = 0; j < y.count(); ++j) {
    for (int i = 0; i < x.count(); ++i) {
      if (i + 1 < x.count() && step(i, j, 1, 0)) mark(i, j), mark(i, j - 1);
      if (j + 1 < y.count() && step(i, j, 0, 1)) mark(i, j), mark(i - 1, j);
    }
  }
}

void Support::inverse_depth_row(int cell_y, std::span<float> out) const {
  const int top = y.left[cell_y], bottom = y.right(cell_y);
  const float down = y.fraction[cell_y];
  std::vector<float> between(x.count());
  for (int i = 0; i < x.count(); ++i) {
    between[i] = inverse_depth(i, top) + down * (inverse_depth(i, bottom) - inverse_depth(i, top));
  }
  for (std::size_t cell = 0; cell < out.size(); ++cell) {
    const float from = between[x.left[cell]], to = between[x.right(static_cast<int>(cell))];
    out[cell] = std::max(from + x.fraction[cell] * (to - from), 0.0F);
  }
}

std::array<float, 4> Support::corners(int cell_x, int cell_y) const {
  const int i = x.left[cell_x], k = x.right(cell_x), j = y.left[cell_y], l = y.right(cell_y);
  std::array<float, 4> found{inverse_depth(i, j), inverse_depth(k, j), inverse_depth(i, l),
                             inverse_depth(k, l)};
  std::ranges::sort(found, std::greater<>());
  return found;
}

}  // namespace macula::kernels::ray
