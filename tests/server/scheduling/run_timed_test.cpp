#include "server/scheduling/run_timed.h"

#include <gtest/gtest.h>

#include <array>
#include <mutex>
#include <numeric>

namespace macula::test {
namespace {

using namespace scheduling;

void spend(double cpu_ms) {
  for (const double begin = base::thread_cpu_ms(); base::thread_cpu_ms() - begin < cpu_ms;) {
  }
}

TEST(RunTimed, EveryPartRunsOnceAndIsToldOnce) {
  constexpr std::size_t kParts = 100;
  TileScheduler scheduler(3);
  std::array<std::atomic<int>, kParts> ran{}, told{};
  run_timed(
      scheduler, NextPart(kParts), [&](std::size_t part) { ++ran[part]; },
      [&](std::size_t part, double) { ++told[part]; });
  for (std::size_t part = 0; part < kParts; ++part) {
    EXPECT_EQ(ran[part], 1) << part;
    EXPECT_EQ(told[part], 1) << part;
  }
}

/// However often it was interrupted meanwhile.
TEST(RunTimed, PartsTogetherCostWhatTheirThreadSpent) {
  constexpr std::array kSpent_ms{20.0, 2.0, 10.0};
  TileScheduler scheduler(1);
  std::array<double, kSpent_ms.size()> costs{};
  run_timed(
      scheduler, NextPart(costs.size()), [&](std::size_t part) { spend(kSpent_ms[part]); },
      [&](std::size_t part, double cost_ms) { costs[part] = cost_ms; });
  const double spent = std::reduce(kSpent_ms.begin(), kSpent_ms.end());
  EXPECT_NEAR(std::reduce(costs.begin(), costs.end()), spent, 0.3 * spent);
}

TEST(RunTimed, WhatEndsEarlyTakesNoMoreParts) {
  TileScheduler scheduler(2);
  std::atomic<std::size_t> given{0}, ran{0};
  run_timed(
      scheduler,
      [&]() -> std::optional<std::size_t> {
        const std::size_t part = given++;
        return part < 5 ? std::optional(part) : std::nullopt;
      },
      [&](std::size_t) { ++ran; }, [](std::size_t, double) {});
  EXPECT_EQ(ran, 5U);
}

}  // namespace
}  // namespace macula::test
