#include "shared/codec/quantiser_offsets.h"

#include <algorithm>
#include <cmath>

#include "shared/codec/h264.h"
#include "shared/foveation/eccentricity.h"

namespace macula::codec {
namespace {

/// The part of `edges` that block `index` covers, as close to `at` as it comes.
float nearest_in_block(const std::vector<float>& edges, std::size_t index, float at) {
  const std::size_t first = index * kMacroblockPx;
  const std::size_t last = std::min(first + kMacroblockPx, edges.size() - 1);
  return std::clamp(at, edges[first], edges[last]);
}

std::size_t blocks_along(const std::vector<float>& edges) {
  return (edges.size() - 1 + kMacroblockPx - 1) / kMacroblockPx;
}

/// How many halvings of the sampling rate the model allows at the block.
class Halvings {
 public:
  Halvings(const PixelGrid& grid, const Gaze& gaze, const foveation::RateModel& model)
      : grid_(grid), gaze_(gaze), model_(model) {
    // A gaze behind the plane is met by whatever lies farthest towards it.
    const Vec3& g = gaze.direction;
    towards_ = g.z < 0.0F ? math::tangent_from_direction(g) : 1e3F * Vec2{g.x, -g.y};
  }
  double at(std::size_t column, std::size_t row) const {
    const Vec2 tangent{nearest_in_block(grid_.x_edges, column, towards_.x),
                       nearest_in_block(grid_.y_edges, row, towards_.y)};
    const Radians e =
        foveation::eccentricity(gaze_.direction, math::direction_from_tangent(tangent));
    return -std::log2(model_.rate(e));
  }

 private:
  const PixelGrid& grid_;
  const Gaze& gaze_;
  const foveation::RateModel& model_;
  Vec2 towards_;
};

}  // namespace

std::vector<float> quantiser_offsets(const PixelGrid& grid, const Gaze& gaze,
                                     const foveation::RateModel& model,
                                     const FovealQuantiser& range) {
  const std::size_t across = blocks_along(grid.x_edges), down = blocks_along(grid.y_edges);
  const Halvings halvings(grid, gaze, model);
  std::vector<float> offsets;
  offsets.reserve(across * down);
  for (std::size_t row = 0; row < down; ++row)
    for (std::size_t column = 0; column < across; ++column)
      offsets.push_back(static_cast<float>(halvings.at(column, row)));
  const float most = *std::max_element(offsets.begin(), offsets.end());
  for (float& offset : offsets) {
    const double share = most > 0.0F ? static_cast<double>(offset / most) : 0.5;
    offset = static_cast<float>(std::lerp(range.finest, range.coarsest, share));
  }
  return offsets;
}

}  // namespace macula::codec
