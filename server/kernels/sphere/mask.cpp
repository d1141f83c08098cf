#include "server/kernels/sphere/mask.h"

#include <algorithm>
#include <cmath>

#include "server/kernels/sphere/importance.h"
#include "server/scheduling/row_bands.h"
#include "shared/foveation/eccentricity.h"

namespace macula::kernels::sphere {
namespace {

/// Four of the smallest cells: what one sample of the middle level stands for.
constexpr float kMidArea = kMidSide * kMidSide;

std::vector<float> steps_of(const std::vector<float>& edges) {
  std::vector<float> steps;
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) steps.push_back(edges[i + 1] - edges[i]);
  const float least = *std::ranges::min_element(steps);
  for (float& step : steps) step /= least;
  return steps;
}

/// Cells' areas in units of the grid's smallest.
class CellAreas {
 public:
  explicit CellAreas(const PixelGrid& grid)
      : x_(steps_of(grid.x_edges)), y_(steps_of(grid.y_edges)) {}

  float area(int x, int y) const { return x_[x] * y_[y]; }
  /// Probability that a cell is traced for its size alone. Steps of a raster differ by rounding.
  float importance(int x, int y) const {
    constexpr float kRounding = 1e-2F;
    return std::clamp((area(x, y) - 1.0F - kRounding) / (kMidArea - 1.0F), 0.0F, 1.0F);
  }

 private:
  std::vector<float> x_, y_;
};

Degrees eccentricity_of(const View& view, const Vec2& tangent) {
  return Degrees{
      foveation::eccentricity(view.gaze.direction, math::direction_from_tangent(tangent))};
}

/// The cells under one low cell, and the range of eccentricities among them.
struct Block {
  int x0, y0, x1, y1;
  double nearest_deg, farthest_deg;
};
Block block_of(const View& view, int low_x, int low_y) {
  const PixelGrid& grid = view.grid;
  Block block{kLowSide * low_x,
              kLowSide * low_y,
              std::min(kLowSide * (low_x + 1), grid.width()),
              std::min(kLowSide * (low_y + 1), grid.height()),
              0.0,
              0.0};
  const Vec2 low{grid.x_edges[block.x0], grid.y_edges[block.y0]};
  const Vec2 high{grid.x_edges[block.x1], grid.y_edges[block.y1]};
  // Angles on the tangent plane are at most the distances there: a disc around the middle.
  const double middle = eccentricity_of(view, 0.5F * (low + high)).value();
  const double radius = Degrees{Radians{0.5 * glm::length(high - low)}}.value();
  block.nearest_deg = middle - radius, block.farthest_deg = middle + radius;
  return block;
}

class Chooser {
 public:
  Chooser(const View& view, const Plane<float>& edges, std::uint64_t frame, std::uint64_t seed,
          const MaskConfig& config, Plane<std::uint8_t>& out)
      : view_(view),
        edges_(edges),
        frame_(frame),
        seed_(seed),
        config_(config),
        areas_(view.grid),
        out_(out) {}

  void choose_row(int low_y) {
    for (int low_x = 0; low_x < edges_.width(); ++low_x) {
      const Block block = block_of(view_, low_x, low_y);
      if (config_.rule == MaskRule::Corrected && block.farthest_deg <= config_.fovea.value()) {
        fill(block);
      } else if (block.nearest_deg <= config_.outer.value() ||
                 areas_.importance(block.x1 - 1, block.y1 - 1) > 0.0F ||
                 areas_.importance(block.x0, block.y0) > 0.0F) {
        choose(block, edges_(low_x, low_y));
      }
    }
  }

 private:
  void fill(const Block& block) {
    for (int y = block.y0; y < block.y1; ++y)
      for (int x = block.x0; x < block.x1; ++x) out_(x, y) = 1;
  }
  /// Importance falls with eccentricity, so that a cell's own is only worked out where its
  /// threshold lies between what the block's nearest and farthest points have.
  void choose(const Block& block, float edge) {
    const double most = importance(Degrees{block.nearest_deg}, edge, config_);
    const double least = importance(Degrees{block.farthest_deg}, edge, config_);
    for (int y = block.y0; y < block.y1; ++y) {
      for (int x = block.x0; x < block.x1; ++x) {
        const double held_against = threshold(x, y, frame_, seed_, config_.rule);
        const bool by_size = held_against < static_cast<double>(areas_.importance(x, y));
        out_(x, y) = by_size || held_against < least ||
                             (held_against < most && held_against < importance_of(x, y, edge))
                         ? 1
                         : 0;
      }
    }
  }
  double importance_of(int x, int y, float edge) const {
    return importance(eccentricity_of(view_, view_.grid.tangent(x, y)), edge, config_);
  }

  const View& view_;
  const Plane<float>& edges_;
  std::uint64_t frame_, seed_;
  const MaskConfig& config_;
  CellAreas areas_;
  Plane<std::uint8_t>& out_;
};

}  // namespace

bool may_thin(const View& view, const MaskConfig& config) {
  if (config.rule == MaskRule::Literal) return true;
  const CellAreas areas(view.grid);
  const PixelGrid low = coarsen(view.grid, kLowSide);
  for (int y = 0; y < low.height(); ++y) {
    for (int x = 0; x < low.width(); ++x) {
      const Block block = block_of(view, x, y);
      if (block.farthest_deg <= config.fovea.value()) continue;
      for (const auto& [cx, cy] : {std::pair{block.x0, block.y0}, {block.x1 - 1, block.y1 - 1}})
        if (areas.importance(cx, cy) < 1.0F) return true;
    }
  }
  return false;
}

Plane<std::uint8_t> important_cells(const View& view, const Plane<float>& edges,
                                    std::uint64_t frame, std::uint64_t seed,
                                    const MaskConfig& config, TileScheduler& scheduler) {
  Plane<std::uint8_t> important(view.grid.width(), view.grid.height(), 0);
  Chooser chooser(view, edges, frame, seed, config, important);
  scheduling::RowBands bands(scheduler, edges.height());
  bands.run(bands.own(), [&](int low_y) { chooser.choose_row(low_y); });
  bands.gather(scheduling::Audience::EveryRank, [&](int low_y, scheduling::Parcel& parcel) {
    const int begin = kLowSide * low_y;
    for (int y = begin; y < std::min(begin + kLowSide, important.height()); ++y)
      parcel.values(important.row(y));
  });
  return important;
}

Plane<MidSource> mid_sources(const Plane<std::uint8_t>& important) {
  const int width = (important.width() + kMidSide - 1) / kMidSide;
  const int height = (important.height() + kMidSide - 1) / kMidSide;
  Plane<MidSource> sources(width, height, MidSource::Traced);
  const auto all_important = [&](int x, int y) {
    for (int cy = kMidSide * y; cy < std::min(kMidSide * (y + 1), important.height()); ++cy)
      for (int cx = kMidSide * x; cx < std::min(kMidSide * (x + 1), important.width()); ++cx)
        if (important(cx, cy) == 0) return false;
    return true;
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      sources(x, y) = all_important(x, y) ? MidSource::Average : MidSource::Traced;
  return sources;
}

}  // namespace macula::kernels::sphere
