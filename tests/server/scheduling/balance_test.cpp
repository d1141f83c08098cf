#include "server/scheduling/balance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "server/scheduling/cost_forecast.h"

namespace macula::test {
namespace {

using namespace scheduling;
using Assigned = std::vector<std::vector<std::uint32_t>>;

bool covers_each_once(const Assigned& assigned, std::size_t tiles) {
  std::vector<std::uint32_t> all;
  for (const auto& own : assigned) all.insert(all.end(), own.begin(), own.end());
  std::ranges::sort(all);
  std::vector<std::uint32_t> each(tiles);
  std::iota(each.begin(), each.end(), 0U);
  return all == each;
}

double imbalance(const Assigned& assigned, const std::vector<float>& costs) {
  double most = 0.0, sum = 0.0;
  for (const auto& own : assigned) {
    double load = 0.0;
    for (const std::uint32_t tile : own) load += static_cast<double>(costs[tile]);
    most = std::max(most, load), sum += load;
  }
  return most * static_cast<double>(assigned.size()) / sum;
}

/// 30 x 30 tiles; those around (x, y) cost ten times what others do.
std::vector<TilePlace> gazed_at(float x, float y, std::vector<float>& costs) {
  std::vector<TilePlace> places;
  costs.clear();
  for (int row = 0; row < 30; ++row) {
    for (int column = 0; column < 30; ++column) {
      const Vec2 at{(static_cast<float>(column) + 0.5F) / 30.0F,
                    (static_cast<float>(row) + 0.5F) / 30.0F};
      places.push_back({0, at, 256.0F});
      costs.push_back(glm::length(at - Vec2{x, y}) < 0.15F ? 1.0F : 0.1F);
    }
  }
  return places;
}

TEST(Balance, EveryTileGoesToOneRank) {
  std::vector<float> costs;
  gazed_at(0.5F, 0.5F, costs);
  for (const int ranks : {1, 2, 3, 7, 256, 2000}) {
    EXPECT_TRUE(covers_each_once(assign_by_cost(costs, ranks), costs.size())) << ranks;
    EXPECT_TRUE(covers_each_once(assign_stripes(costs.size(), ranks), costs.size())) << ranks;
  }
}

TEST(Balance, ByCostRanksFinishTogetherWhereverThePersonLooksAndStripesDoNot) {
  std::vector<float> costs;
  for (const float x : {0.2F, 0.5F, 0.9F}) {
    for (const float y : {0.1F, 0.5F, 0.8F}) {
      gazed_at(x, y, costs);
      for (const int ranks : {2, 4, 16})
        EXPECT_LE(imbalance(assign_by_cost(costs, ranks), costs), 1.1) << x << y << ranks;
    }
  }
  gazed_at(0.5F, 0.1F, costs);
  EXPECT_GT(imbalance(assign_stripes(costs.size(), 4), costs), 1.5);
}

TEST(CostForecast, FollowsWhatTheLastFrameCostToWhereItIsSeenNow) {
  std::vector<float> before, now;
  const auto places = gazed_at(0.3F, 0.5F, before);
  CostForecast forecast;
  forecast.begin_frame({});
  EXPECT_EQ(forecast.expect(places), std::vector<float>(places.size(), 256.0F));  // work alone
  forecast.learn(places, before);

  // The head turns: all that was seen moves by a fifth of the view.
  gazed_at(0.5F, 0.5F, now);
  CostForecast ignorant = forecast;
  forecast.begin_frame([](const TilePlace& tile) -> std::optional<Vec2> {
    const Vec2 then = tile.at - Vec2{0.2F, 0.0F};
    return then.x > 0.0F ? std::optional(then) : std::nullopt;
  });
  ignorant.begin_frame({});
  const auto off = [&](const std::vector<float>& expected) {
    double sum = 0.0;
    for (std::size_t i = 0; i < now.size(); ++i)
      sum += std::abs(static_cast<double>(expected[i] - now[i]));
    return sum / std::accumulate(now.begin(), now.end(), 0.0);
  };
  EXPECT_LT(off(forecast.expect(places)), 0.25);
  EXPECT_GT(off(ignorant.expect(places)), 0.4);  // the twin that forgets the turn
}

TEST(CostForecast, MoreWorkAtTheSamePlaceCostsMore) {
  CostForecast forecast;
  forecast.begin_frame({});
  std::vector<TilePlace> places = {{0, {0.1F, 0.1F}, 10.0F}, {0, {0.9F, 0.9F}, 10.0F}};
  (void)forecast.expect(places);
  forecast.learn(places, std::vector<float>{2.0F, 4.0F});
  forecast.begin_frame({});
  places[0].work = 30.0F;
  EXPECT_EQ(forecast.expect(places), (std::vector<float>{6.0F, 4.0F}));
}

}  // namespace
}  // namespace macula::test
