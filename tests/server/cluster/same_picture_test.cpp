// Every kernel in both modes, by 2, 3 and 4 ranks (threads here): the same bits as by one process
// alone, over frames that remember, whoever runs which tile.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <thread>

#include "tests/server/cluster/shared_frames.h"
#include "tests/server/cluster/thread_ranks.h"

namespace macula::test {
namespace {

using cluster::Leader;
using cluster::RankedKernel;
using scheduling::Balance;

struct Together {
  int ranks = 2;
  Balance balance = Balance::Predicted;
  Tamper tamper{};
  int threads = 1;
};
Pictures render_together(const Case& of, const Together& how) {
  const auto meeting = std::make_shared<Meeting>(how.ranks);
  meeting->tamper = how.tamper;
  const KernelList kernels = kernels_of(of);
  std::vector<std::thread> others;
  for (int rank = 1; rank < how.ranks; ++rank) {
    others.emplace_back([&, rank] {
      ThreadRanks ranks(meeting, rank);
      const auto timeline = timeline_of(of.scene);
      TileScheduler scheduler(how.threads);
      const auto done = cluster::follow(ranks, {kernels, *timeline, scheduler, how.balance});
      EXPECT_TRUE(done) << (done ? "" : done.error().message());
    });
  }
  const auto leader =
      std::make_shared<Leader>(std::make_shared<ThreadRanks>(meeting, 0), how.balance);
  const auto timeline = timeline_of(of.scene);
  TileScheduler scheduler(how.threads);
  Pictures pictures = render(RankedKernel(kernels[0], 0, leader), *timeline, scheduler);
  leader->end();
  for (std::thread& other : others) other.join();
  return pictures;
}

class Ranks : public testing::TestWithParam<Case> {};

TEST_P(Ranks, TwoThreeAndFourGiveTheBitsOfOne) {
  const Pictures alone = render_alone(GetParam());
  for (const int ranks : {1, 2, 3, 4}) {
    EXPECT_TRUE(same_bits(alone, render_together(GetParam(), {ranks}))) << ranks << " ranks";
  }
}

TEST_P(Ranks, NoBalanceChangesABit) {
  const Pictures alone = render_alone(GetParam());
  for (const Balance balance : {Balance::Stripes, Balance::Dynamic}) {
    EXPECT_TRUE(same_bits(alone, render_together(GetParam(), {2, balance, {}, 2})));
  }
}

INSTANTIATE_TEST_SUITE_P(Kernels, Ranks, testing::ValuesIn(cases()),
                         [](const auto& of) { return "case" + std::to_string(of.index); });

/// The twin: what rank 1's tiles left behind comes in another order.
TEST(RanksTwin, SwappedTilesGiveAnotherPicture) {
  const auto swap_parts = [](int rank, int, std::span<std::byte> message) {
    if (rank != 1 || message.size() < 8192) return;  // payloads, not the lists of tiles
    const std::size_t half = message.size() / 8 * 4;
    std::swap_ranges(message.begin() + 512, message.begin() + 2048,
                     message.begin() + static_cast<std::ptrdiff_t>(half));
  };
  const Case& of = cases().front();  // its payloads are pixels alone
  EXPECT_TRUE(same_bits(render_alone(of), render_together(of, {2})));
  EXPECT_FALSE(
      same_bits(render_alone(of), render_together(of, {2, Balance::Predicted, swap_parts})));
}

/// Rank 0 is told to stop in the middle of a pass: all ranks leave the same pass, and stop there.
TEST(RanksStop, AStopOfRankZeroStopsAllInTheSamePass) {
  constexpr std::size_t kTiles = 400;
  const auto meeting = std::make_shared<Meeting>(2);
  std::stop_source stop;
  std::atomic<std::size_t> ran{0};
  std::array<int, 2> completed{};
  const auto take_part = [&](int rank) {
    ThreadRanks ranks(meeting, rank);
    scheduling::CostForecast forecast;
    forecast.begin_frame({});
    scheduling::FrameSharing sharing(ranks, Balance::Predicted, forecast);
    TileScheduler scheduler(1);
    const scheduling::SharedPass pass{std::vector<scheduling::TilePlace>(kTiles)};
    const auto body = [&](std::size_t) {
      std::this_thread::sleep_for(std::chrono::milliseconds{1});
      if (++ran == kTiles + 20) stop.request_stop();  // early in the second pass
    };
    const auto token = rank == 0 ? stop.get_token() : std::stop_token{};
    const auto nothing = [](std::size_t, scheduling::Parcel&) {};
    while (sharing.run(scheduler, pass, body, nothing, token) == scheduling::Outcome::Completed)
      ++completed[static_cast<std::size_t>(rank)];
  };
  std::thread other([&] { take_part(1); });
  take_part(0);
  other.join();
  EXPECT_EQ(completed[0], 1);
  EXPECT_EQ(completed[1], 1);
  EXPECT_LT(ran.load(), 2 * kTiles - 100) << "nobody went on to the pass's end";
}

/// Ranks that do not agree on who runs what: some tiles come twice, others never.
TEST(RanksDeathTest, ATileThatIsLostOrComesTwiceEndsTheProcess) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  const auto disagree = [] {
    const auto meeting = std::make_shared<Meeting>(2);
    std::thread other([&] {
      ThreadRanks ranks(meeting, 1);
      scheduling::CostForecast forecast;
      forecast.begin_frame({});
      scheduling::FrameSharing sharing(ranks, Balance::Stripes, forecast);
      TileScheduler scheduler(1);
      const auto nothing = [](std::size_t, scheduling::Parcel&) {};
      (void)sharing.run(scheduler, {std::vector<scheduling::TilePlace>(7)}, [](std::size_t) {},
                        nothing, {});
    });
    ThreadRanks ranks(meeting, 0);
    scheduling::CostForecast forecast;
    forecast.begin_frame({});
    scheduling::FrameSharing sharing(ranks, Balance::Predicted, forecast);
    TileScheduler scheduler(1);
    const auto nothing = [](std::size_t, scheduling::Parcel&) {};
    (void)sharing.run(scheduler, {std::vector<scheduling::TilePlace>(7)}, [](std::size_t) {},
                      nothing, {});
    other.join();
  };
  EXPECT_DEATH(disagree(), "no tile comes twice");
}

}  // namespace
}  // namespace macula::test
