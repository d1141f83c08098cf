#include "server/kernels/sphere/edges.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace macula::kernels::sphere {
namespace {

/// Reads with coordinates clamped to the plane.
float at(const Plane<float>& plane, int x, int y) {
  return plane(std::clamp(x, 0, plane.width() - 1), std::clamp(y, 0, plane.height() - 1));
}

/// Second difference of a quantity that is affine over planes, as a share of its own value. With
/// unequal steps it is the difference of the slopes times the mean step.
float bend(float before, float here, float after, float step_before, float step_after) {
  const float slopes = (after - here) / step_after - (here - before) / step_before;
  return std::abs(slopes) * 0.5F * (step_before + step_after);
}

std::vector<float> middles(const std::vector<float>& edges) {
  std::vector<float> middles;
  for (std::size_t i = 0; i + 1 < edges.size(); ++i)
    middles.push_back(0.5F * (edges[i] + edges[i + 1]));
  return middles;
}

/// The steps between samples around sample i; the plane's border repeats its last step.
struct Steps {
  float before, after;
};
Steps steps_at(const std::vector<float>& centres, int i) {
  const int last = static_cast<int>(centres.size()) - 1;
  if (last == 0) return {1.0F, 1.0F};
  const float before = i > 0 ? centres[i] - centres[i - 1] : centres[1] - centres[0];
  const float after = i < last ? centres[i + 1] - centres[i] : centres[last] - centres[last - 1];
  return {before, after};
}

class Detector {
 public:
  Detector(const LowLevel& low, const PixelGrid& grid, const MaskConfig& config)
      : low_(low), config_(config), columns_(middles(grid.x_edges)), rows_(middles(grid.y_edges)) {}

  bool edge(int x, int y) const {
    const bool depth = config_.rule == MaskRule::Literal ? sobel_edge(x, y) : depth_edge(x, y);
    return depth || (low_.luminance.size() > 0 && luminance_edge(x, y));
  }

 private:
  /// 1/z is affine over a plane however slanted, so only creases and steps are seen. A border
  /// sample is compared with itself outside and so has half its bend.
  bool depth_edge(int x, int y) const {
    const Plane<float>& q = low_.inverse_depth;
    const float here = q(x, y);
    for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
      if ((at(q, x + dx, y + dy) > 0.0F) != (here > 0.0F)) return true;
    }
    if (!(here > 0.0F)) return false;
    const float across = inside(x, q.width()) ? bend_x(x, y) : 0.0F;
    const float down = inside(y, q.height()) ? bend_y(x, y) : 0.0F;
    return std::max(across, down) > config_.thresholds.inverse_depth * here;
  }
  static bool inside(int i, int count) { return i > 0 && i < count - 1; }
  float bend_x(int x, int y) const {
    const Plane<float>& q = low_.inverse_depth;
    const Steps steps = steps_at(columns_, x);
    return bend(q(x - 1, y), q(x, y), q(x + 1, y), steps.before, steps.after);
  }
  float bend_y(int x, int y) const {
    const Plane<float>& q = low_.inverse_depth;
    const Steps steps = steps_at(rows_, y);
    return bend(q(x, y - 1), q(x, y), q(x, y + 1), steps.before, steps.after);
  }

  bool luminance_edge(int x, int y) const {
    const Plane<float>& l = low_.luminance;
    const float across = std::abs(at(l, x + 1, y) - at(l, x - 1, y));
    const float down = std::abs(at(l, x, y + 1) - at(l, x, y - 1));
    return std::max(across, down) > config_.thresholds.luminance;
  }

  /// The paper's filter, on marched distances; a miss lies farther than any scene reaches.
  bool sobel_edge(int x, int y) const {
    const auto d = [&](int dx, int dy) {
      const float value = at(low_.distance, x + dx, y + dy);
      return std::isfinite(value) ? value : kFarAway_m;
    };
    const float across =
        d(1, -1) + 2.0F * d(1, 0) + d(1, 1) - d(-1, -1) - 2.0F * d(-1, 0) - d(-1, 1);
    const float down = d(-1, 1) + 2.0F * d(0, 1) + d(1, 1) - d(-1, -1) - 2.0F * d(0, -1) - d(1, -1);
    return std::hypot(across, down) > config_.thresholds.sobel_m;
  }
  static constexpr float kFarAway_m = 1e7F;

  const LowLevel& low_;
  const MaskConfig& config_;
  std::vector<float> columns_, rows_;
};

}  // namespace

Plane<float> find_edges(const LowLevel& low, const PixelGrid& low_grid, const MaskConfig& config) {
  const Detector detector(low, low_grid, config);
  const int width = low.inverse_depth.width(), height = low.inverse_depth.height();
  Plane<float> edges(width, height, 0.0F);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (!detector.edge(x, y)) continue;
      for (int ny = std::max(y - 1, 0); ny <= std::min(y + 1, height - 1); ++ny)
        for (int nx = std::max(x - 1, 0); nx <= std::min(x + 1, width - 1); ++nx)
          edges(nx, ny) = 1.0F;
    }
  }
  return edges;
}

}  // namespace macula::kernels::sphere
