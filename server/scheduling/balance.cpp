#include "server/scheduling/balance.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <queue>
#include <utility>

namespace macula::scheduling {

std::vector<std::vector<std::uint32_t>> assign_by_cost(std::span<const float> costs, int ranks) {
  std::vector<std::uint32_t> order(costs.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::stable_sort(order, [&](auto a, auto b) { return costs[a] > costs[b]; });
  using Load = std::pair<double, int>;  // equal loads: the lower rank
  std::priority_queue<Load, std::vector<Load>, std::greater<>> least;
  for (int rank = 0; rank < ranks; ++rank) least.emplace(0.0, rank);
  std::vector<std::vector<std::uint32_t>> tiles(static_cast<std::size_t>(ranks));
  for (const std::uint32_t tile : order) {
    const auto [load, rank] = least.top();
    least.pop();
    tiles[static_cast<std::size_t>(rank)].push_back(tile);
    least.emplace(load + static_cast<double>(costs[tile]), rank);
  }
  return tiles;
}

std::vector<std::vector<std::uint32_t>> assign_stripes(std::size_t tiles, int ranks) {
  std::vector<std::vector<std::uint32_t>> stripes(static_cast<std::size_t>(ranks));
  for (std::size_t rank = 0; rank < stripes.size(); ++rank) {
    stripes[rank].resize(tiles * (rank + 1) / stripes.size() - tiles * rank / stripes.size());
    std::iota(stripes[rank].begin(), stripes[rank].end(),
              static_cast<std::uint32_t>(tiles * rank / stripes.size()));
  }
  return stripes;
}

}  // namespace macula::scheduling
