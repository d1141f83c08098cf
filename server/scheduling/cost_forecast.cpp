#include "server/scheduling/cost_forecast.h"

#include <algorithm>
#include <utility>

namespace macula::scheduling {

std::size_t CostForecast::texel_of(const Vec2& place) {
  const auto index = [](float share) {
    return std::clamp(static_cast<int>(share * kSide), 0, kSide - 1);
  };
  return static_cast<std::size_t>(index(place.y) * kSide + index(place.x));
}

float CostForecast::Map::at(const Vec2& place) const {
  const std::size_t texel = texel_of(place);
  return work[texel] > 0.0F ? cost[texel] / work[texel] : mean;
}

void CostForecast::begin_frame(PlaceThen place_then) {
  place_then_ = std::move(place_then);
  last_ = std::exchange(now_, {});
  asked_ = 0;
}

std::vector<float> CostForecast::expect(std::span<const TilePlace> tiles) {
  const std::size_t pass = asked_++;
  std::vector<float> costs(tiles.size());
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const TilePlace& tile = tiles[i];
    costs[i] = tile.work;
    if (pass >= last_.size() || tile.view >= last_[pass].size()) continue;
    const Map& map = last_[pass][tile.view];
    if (!(map.mean > 0.0F)) continue;
    const auto then = place_then_ ? place_then_(tile) : std::optional(tile.at);
    costs[i] *= then ? map.at(*then) : map.mean;
  }
  return costs;
}

void CostForecast::learn(std::span<const TilePlace> tiles, std::span<const float> costs_ms) {
  Pass pass;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    if (tiles[i].view >= pass.size()) pass.resize(tiles[i].view + 1);
    Map& map = pass[tiles[i].view];
    map.cost[texel_of(tiles[i].at)] += costs_ms[i];
    map.work[texel_of(tiles[i].at)] += tiles[i].work;
  }
  for (Map& map : pass) {
    float cost = 0.0F, work = 0.0F;
    for (std::size_t k = 0; k < map.cost.size(); ++k) cost += map.cost[k], work += map.work[k];
    map.mean = work > 0.0F ? cost / work : 0.0F;
  }
  now_.push_back(std::move(pass));
}

}  // namespace macula::scheduling
