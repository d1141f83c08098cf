#include "server/scheduling/row_bands.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <thread>

#include "tests/server/cluster/thread_ranks.h"

namespace macula::test {
namespace {

using namespace scheduling;

constexpr int kHeight = 37, kReach = 5;
using Column = std::vector<int>;

/// body(scheduler, rank) on every rank, as in a frame that they share.
template <class Body>
void on_ranks(int count, const Body& body) {
  const auto meeting = std::make_shared<Meeting>(count);
  const auto take_part = [&](int rank) {
    ThreadRanks ranks(meeting, rank);
    CostForecast forecast;
    forecast.begin_frame({});
    FrameSharing sharing(ranks, Balance::Predicted, forecast);
    TileScheduler scheduler(1);
    scheduler.share(&sharing);
    body(scheduler, rank);
  };
  std::vector<std::thread> others;
  for (int rank = 1; rank < count; ++rank) others.emplace_back(take_part, rank);
  take_part(0);
  for (std::thread& other : others) other.join();
}

enum class Lending { No, Yes };

/// Twice, every row becomes the sum of those within reach, in numbers that wrap around.
Column summed(TileScheduler& scheduler, Lending lending) {
  RowBands bands(scheduler, kHeight);
  Column now(kHeight), next(kHeight);
  bands.run(bands.own(), [&](int y) { now[static_cast<std::size_t>(y)] = y * y + 1; });
  const auto carry = [&](int y, Parcel& parcel) { parcel.value(now[static_cast<std::size_t>(y)]); };
  for (int step = 0; step < 2; ++step) {
    if (lending == Lending::Yes) {
      EXPECT_EQ(bands.lend(kReach, carry), Outcome::Completed);
    }
    bands.run(bands.own(), [&](int y) {
      const auto first = now.begin() + std::max(y - kReach, 0);
      const auto end = now.begin() + std::min(y + kReach + 1, kHeight);
      next[static_cast<std::size_t>(y)] = std::accumulate(first, end, 0);
    });
    std::swap(now, next);
  }
  EXPECT_EQ(bands.gather(Audience::RankZero, carry), Outcome::Completed);
  return now;
}

TEST(RowBands, StepsThatReadTheirNeighboursGiveWhatOneProcessMakes) {
  TileScheduler alone(1);
  const Column expected = summed(alone, Lending::Yes);
  for (const int count : {1, 2, 3, 4, 40}) {  // of 40, three have no row
    on_ranks(count, [&](TileScheduler& scheduler, int rank) {
      const Column made = summed(scheduler, Lending::Yes);
      if (rank == 0) {
        EXPECT_EQ(made, expected) << count << " ranks";
      }
    });
  }
}

/// The twin that forgets to lend.
TEST(RowBands, WithoutWhatNeighboursLendTheRowsAreOthers) {
  TileScheduler alone(1);
  const Column expected = summed(alone, Lending::No);
  on_ranks(2, [&](TileScheduler& scheduler, int rank) {
    const Column made = summed(scheduler, Lending::No);
    if (rank == 0) {
      EXPECT_NE(made, expected);
    }
  });
}

TEST(RowBands, EachRankFetchesTheRowsThatItNames) {
  on_ranks(3, [](TileScheduler& scheduler, int rank) {
    RowBands bands(scheduler, kHeight);
    Column owners(kHeight, -1);
    bands.run(bands.own(), [&](int y) { owners[static_cast<std::size_t>(y)] = rank; });
    const Rows wanted[] = {{30, 33}, {10 * rank, 10 * rank + 8}, {}};
    const auto done = bands.fetch(
        wanted, [&](int y, Parcel& parcel) { parcel.value(owners[static_cast<std::size_t>(y)]); });
    EXPECT_EQ(done, Outcome::Completed);
    for (int y = 10 * rank; y < 33; ++y)
      EXPECT_EQ(owners[static_cast<std::size_t>(y)], y < 12   ? 0
                                                     : y < 24 ? 1
                                                              : 2)
          << rank << " " << y;
    if (rank == 2) {
      EXPECT_EQ(owners[19], -1) << "nobody asked";
    }
  });
}

TEST(RowBands, WhatStepsCostIsRecordedByTheirReachAndWhatTheyHandOver) {
  for (const int count : {1, 2}) {
    on_ranks(count, [&](TileScheduler& scheduler, int rank) {
      RowBands bands(scheduler, kHeight);
      bands.run(bands.around(3), [](int) {});
      bands.run(bands.own(), [](int) {});
      bands.run(bands.around(3), [](int) {});
      (void)bands.lend(kReach, [](int y, Parcel& parcel) { parcel.value(y); });
      ASSERT_TRUE(scheduler.sharing()->tell_row_costs());
      const PassRecord& record = scheduler.sharing()->passes().back();
      EXPECT_TRUE(record.over_rows);
      EXPECT_GT(record.rank_costs_ms.at(static_cast<std::size_t>(count - 1 - rank)), 0.0);
      EXPECT_EQ(record.reads[20].begin, 20 - kReach);
      EXPECT_EQ(record.reads[20].end, 20 + kReach + 1);
      if (count > 1) {
        EXPECT_EQ(record.bytes_received, kReach * sizeof(int));
        return;
      }
      ASSERT_EQ(record.steps.size(), 2U);
      EXPECT_EQ(record.steps[0].reach, 3);
      EXPECT_EQ(record.steps[1].reach, 0);
      EXPECT_EQ(record.bytes, std::vector<std::uint32_t>(kHeight, sizeof(int)));
    });
  }
}

TEST(RowBands, StepsAfterTheLastTradeAreRecordedToo) {
  on_ranks(2, [](TileScheduler& scheduler, int) {
    {
      RowBands(scheduler, kHeight).run(Band{{0, kHeight}}, [](int) {});
    }
    { const RowBands idle(scheduler, kHeight); }
    ASSERT_EQ(scheduler.sharing()->passes().size(), 1U);
    EXPECT_GT(*std::ranges::max_element(scheduler.sharing()->passes()[0].rank_costs_ms), 0.0);
    EXPECT_EQ(scheduler.sharing()->passes()[0].bytes_received, 0U);
  });
}

TEST(RowBands, PartsOfTilesAreCutWhereThePictureIs) {
  on_ranks(2, [](TileScheduler& scheduler, int rank) {
    RowBands bands(scheduler, kHeight);
    std::vector<int> begins;
    bands.run_tile_rows(bands.own(), 16, [&](const Rows& part) { begins.push_back(part.begin); });
    EXPECT_EQ(begins, rank == 0 ? std::vector({0, 16}) : std::vector({18, 32}));
  });
}

}  // namespace
}  // namespace macula::test
