#include <cmath>

#include <gtest/gtest.h>

#include "server/kernels/registry.h"
#include "tests/bench/tradeoff_cases.h"
#include "tests/bench/tradeoff_front.h"
#include "tests/bench/tradeoff_ladder.h"

namespace macula::bench {
namespace {

Fields row(const std::string& config, double cpu_ms, double error, bool uniform,
           const std::string& scene = "posts") {
  return {{"kernel", std::string("ray")},
          {"scene", scene},
          {"config", config},
          {"cpu_ms", cpu_ms},
          {"rmse_f10", error},
          {"rmse_ew", error},
          {"flip_out10", error},
          {"flicker_t1", 1e-3},
          {"rmse_estimated", 1.2 * error},
          {"uniform", uniform}};
}

TEST(TradeoffCases, EveryConfigurationFitsItsKernel) {
  for (const TradeoffKernel& kernel : tradeoff_kernels()) {
    EXPECT_GE(kernel.scenes.size(), 3U);
    std::vector<std::string> all = kernel.uniform;
    all.insert(all.end(), kernel.knobs.begin(), kernel.knobs.end());
    for (const std::string& config : all) {
      const auto settings = parse_frame_settings(config);
      ASSERT_TRUE(settings) << config;
      EXPECT_TRUE(kernels::make_kernel(kernel.name, {}, settings->knobs)) << config;
    }
    for (const std::string& config : kernel.costly)
      EXPECT_NE(std::ranges::find(all, config), all.end()) << config << " is no configuration";
  }
}

TEST(TradeoffCases, AWrongWordIsNamed) {
  EXPECT_FALSE(parse_frame_settings("grid=round"));
  EXPECT_FALSE(parse_frame_settings("scale=2"));
  EXPECT_FALSE(parse_frame_settings("depth=3"));
  EXPECT_FALSE(parse_frame_settings("model=nobodys"));
}

TEST(TradeoffFront, HoldsWhatNoOtherBeats) {
  const std::vector<CostAndError> points{{4, 1}, {1, 4}, {2, 5}, {2, 2}, {4, 3}, {8, 1}};
  EXPECT_EQ(pareto_front(points), (std::vector<std::size_t>{1, 3, 0}));
}

// Error of whole pictures 1 / time; foveated ones half of that from 1 to 100 ms.
TEST(TradeoffFront, CountsTheDecadesInWhichFoveatedPicturesAreBetter) {
  std::vector<Fields> rows;
  for (int k = 0; k <= 40; ++k) {
    const double ms = std::pow(10.0, k / 20.0);
    rows.push_back(row("u", ms, 1.0 / ms, true));
    rows.push_back(row("f", ms, 0.5 / ms, false));
  }
  const Advantage all = foveated_advantage(rows, "rmse_f10");
  EXPECT_NEAR(all.of_decades, 2.0, 0.05);
  EXPECT_NEAR(all.below_decades, all.of_decades, 1e-9);
  EXPECT_NEAR(all.mean_ratio, 2.0, 0.15);
  // The twin: twice the error instead is better nowhere.
  for (Fields& one : rows)
    if (text_in(one, "config") == "f") set_field(one, "rmse_f10", 2.0 / number_in(one, "cpu_ms"));
  EXPECT_EQ(foveated_advantage(rows, "rmse_f10").below_decades, 0.0);
}

TEST(TradeoffFront, CodecsAreNoWayToRender) {
  std::vector<Fields> rows{row("jpeg=50", 1.0, 0.01, false), row("scale=1", 2.0, 0.02, false)};
  mark_fronts(rows);
  EXPECT_EQ(std::get<bool>(value_in(rows[0], "on_front")), false);
  EXPECT_EQ(std::get<bool>(value_in(rows[1], "on_front")), true);
}

TEST(TradeoffLadder, HasTheStepsThatNoOtherBeatsOverAllScenes) {
  std::vector<Fields> rows;
  for (const char* scene : {"posts", "atrium"}) {
    const double slow = scene[0] == 'a' ? 4.0 : 1.0;
    rows.push_back(row("scale=0.3", 1.0 * slow, 0.1, false, scene));
    rows.push_back(row("scale=0.5", 2.0 * slow, 0.2, false, scene));  // beaten
    rows.push_back(row("samples=4", 8.0 * slow, 0.02, false, scene));
    rows.push_back(row("grid=uniform", 9.0 * slow, 0.001, true, scene));
    rows.push_back(row("model=ray-small", 3.0 * slow, 0.001, false, scene));
  }
  rows.push_back(row("samples=8", 16.0, 0.01, false, "posts"));  // not on every scene
  const auto steps = ladder_steps(rows);
  ASSERT_EQ(steps.size(), 2U);
  EXPECT_EQ(steps[0].config, "scale=0.3");
  EXPECT_EQ(steps[1].config, "samples=4");
  EXPECT_NEAR(steps[0].cost_ms, 2.0, 1e-9);
}

// What flickers is seen though its mean error is small.
TEST(TradeoffLadder, AStepThatFlickersGivesWayToASteadyOne) {
  std::vector<Fields> rows;
  for (const char* scene : {"posts", "atrium"}) {
    rows.push_back(row("scale=0.3", 1.0, 0.1, false, scene));
    rows.push_back(row("lights=1", 2.0, 0.05, false, scene));
    rows.push_back(row("method=foveated", 3.0, 0.045, false, scene));
    rows.push_back(row("samples=4", 8.0, 0.02, false, scene));
    set_field(rows[rows.size() - 3], "flicker_t1", 0.1);
  }
  const auto steps = ladder_steps(rows);
  ASSERT_EQ(steps.size(), 3U);
  EXPECT_EQ(steps[1].config, "method=foveated");
}

// Where knobs stay, a ladder may go anywhere between two resolutions; the last step of all is not
// worth a third more for a hundredth less error.
TEST(TradeoffLadder, KeepsTheWholeRangeOfAResolutionAndNoLastStepThatIsHardlyBetter) {
  std::vector<Fields> rows;
  for (const char* scene : {"posts", "atrium"}) {
    rows.push_back(row("scale=0.2 lights=1", 1.0, 0.1, false, scene));
    rows.push_back(row("scale=0.4 lights=1", 1.3, 0.07, false, scene));
    rows.push_back(row("scale=0.7 lights=1", 1.6, 0.068, false, scene));
    rows.push_back(row("lights=1", 2.0, 0.065, false, scene));
    rows.push_back(row("samples=2", 3.0, 0.0505, false, scene));
    rows.push_back(row("samples=4", 4.0, 0.05, false, scene));
  }
  const auto steps = ladder_steps(rows);
  ASSERT_EQ(steps.size(), 4U);
  EXPECT_EQ(steps[0].config, "scale=0.2 lights=1");
  EXPECT_EQ(steps[1].config, "scale=0.4 lights=1");
  EXPECT_EQ(steps[2].config, "lights=1");
  EXPECT_EQ(steps[3].config, "samples=2");
}

TEST(TradeoffLadder, KendallsTauIsOneForTheSameOrderAndMinusOneForTheReverse) {
  const std::vector<double> rising{1, 2, 3, 4}, falling{4, 3, 2, 1}, swapped{2, 1, 3, 4};
  EXPECT_EQ(kendall_tau(rising, rising), 1.0);
  EXPECT_EQ(kendall_tau(rising, falling), -1.0);
  EXPECT_NEAR(kendall_tau(rising, swapped), 4.0 / 6.0, 1e-12);
  // Two that are alike have no order; the twin: alike by less than is asked, they count.
  const std::vector<double> alike{1.0, 1.02, 3.0}, turned{2.0, 1.0, 3.0};
  EXPECT_EQ(kendall_tau(alike, turned, 0.05), 1.0);
  EXPECT_NEAR(kendall_tau(alike, turned, 0.01), 1.0 / 3.0, 1e-12);
}

// Estimates are a fifth too large; on the third scene so, or by a half.
TEST(TradeoffLadder, TellsHowWellErrorsOfASceneLeftOutAreEstimated) {
  std::vector<Fields> rows;
  for (const char* scene : {"posts", "atrium", "city"}) {
    rows.push_back(row("scale=0.3", 1.0, 0.1, false, scene));
    rows.push_back(row("samples=4", 8.0, 0.02, false, scene));
  }
  EXPECT_EQ(check_estimates(rows, "city").steps, 2);
  EXPECT_EQ(check_estimates(rows, "city").share_within_30, 1.0);
  EXPECT_EQ(check_estimates(rows, "city").kendall_tau, 1.0);
  for (Fields& one : rows)
    if (text_in(one, "scene") == "city")
      set_field(one, "rmse_estimated", number_in(one, "rmse_ew") * 1.5);
  EXPECT_EQ(check_estimates(rows, "city").share_within_30, 0.0);
  EXPECT_NEAR(check_estimates(rows, "city").worst_factor, 1.5, 1e-9);
}

}  // namespace
}  // namespace macula::bench
