#include "server/scheduling/tile_scheduler.h"

#include <gtest/gtest.h>
#include <immintrin.h>

#include <atomic>
#include <limits>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

namespace macula::scheduling {
namespace {

constexpr unsigned kFlushBits = 0x8040;  // FTZ and DAZ of MXCSR

TEST(TileScheduler, RunsEveryIndexExactlyOnceForOneToEightThreads) {
  for (int threads = 1; threads <= 8; ++threads) {
    TileScheduler scheduler(threads);
    EXPECT_EQ(scheduler.threads(), threads);
    for (const std::size_t count : {1U, 2U, 7U, 1000U}) {
      std::vector<int> runs(count, 0);  // plain ints: run() itself must order them for the caller
      EXPECT_EQ(scheduler.run(count, [&](std::size_t i) { ++runs[i]; }), Outcome::Completed);
      EXPECT_EQ(runs, std::vector<int>(count, 1)) << threads << " threads, " << count << " tiles";
    }
  }
}

TEST(TileScheduler, CompletesWithoutCallingTheBodyWhenThereIsNothingToDo) {
  TileScheduler scheduler(2);
  int calls = 0;
  EXPECT_EQ(scheduler.run(0, [&](std::size_t) { ++calls; }), Outcome::Completed);
  EXPECT_EQ(scheduler.run_tiles(0, 5, 16, [&](image::Rect) { ++calls; }), Outcome::Completed);
  EXPECT_EQ(calls, 0);
}

TEST(TileScheduler, TilesCoverEveryPixelOfThePictureOnceAndStayInside) {
  TileScheduler scheduler(3);
  for (const auto& [width, height] : {std::pair{1, 1}, {16, 16}, {33, 17}, {5, 100}}) {
    image::Plane<int> hits(width, height);
    scheduler.run_tiles(width, height, 16, [&](image::Rect tile) {
      ASSERT_LE(tile.width, 16);
      ASSERT_LE(tile.height, 16);
      for (int y = tile.y; y < tile.y + tile.height; ++y)
        for (int x = tile.x; x < tile.x + tile.width; ++x) ++hits(x, y);
    });
    for (const int n : hits.pixels()) ASSERT_EQ(n, 1);
  }
}

TEST(TileScheduler, StopsAfterTheTilesAlreadyBegun) {
  for (const int threads : {1, 4}) {
    TileScheduler scheduler(threads);
    std::stop_source source;
    scheduler.set_stop_token(source.get_token());
    std::atomic<int> begun{0};
    const Outcome outcome = scheduler.run(10'000, [&](std::size_t) {
      const int order = ++begun;
      if (order == 5) source.request_stop();
      while (order > 5 && !source.stop_requested()) std::this_thread::yield();
    });
    EXPECT_EQ(outcome, Outcome::Stopped);
    EXPECT_GE(begun.load(), 5);
    EXPECT_LE(begun.load(), 5 + threads - 1);  // one tile each for those past their check
  }
}

TEST(TileScheduler, RunsAgainAfterAStopWithAFreshToken) {
  TileScheduler scheduler(2);
  std::stop_source stopped;
  stopped.request_stop();
  scheduler.set_stop_token(stopped.get_token());
  EXPECT_EQ(scheduler.run(3, [](std::size_t) {}), Outcome::Stopped);
  scheduler.set_stop_token({});
  EXPECT_EQ(scheduler.run(3, [](std::size_t) {}), Outcome::Completed);
}

TEST(TileScheduler, AStopAfterTheLastTileDoesNotUndoTheRun) {
  TileScheduler scheduler(1);
  std::stop_source source;
  scheduler.set_stop_token(source.get_token());
  const auto outcome = scheduler.run(4, [&](std::size_t i) {
    if (i == 3) source.request_stop();
  });
  EXPECT_EQ(outcome, Outcome::Completed);  // one thread runs tiles in order, so 3 is the last
}

TEST(TileScheduler, ATileMayRunTilesOfItsOwn) {
  TileScheduler scheduler(3);
  std::vector<std::vector<int>> runs(20, std::vector<int>(50, 0));
  const auto outcome = scheduler.run(runs.size(), [&](std::size_t outer) {
    scheduler.run(runs[outer].size(), [&](std::size_t inner) { ++runs[outer][inner]; });
  });
  EXPECT_EQ(outcome, Outcome::Completed);
  for (const auto& row : runs) EXPECT_EQ(row, std::vector<int>(50, 1));
}

TEST(TileScheduler, ReallyUsesTheThreadsItWasGiven) {
  // Every tile waits for three others on other threads; with fewer than four threads none would
  // end.
  TileScheduler scheduler(4);
  std::atomic<int> present{0};
  std::mutex guard;
  std::set<std::thread::id> seen;
  scheduler.run(4, [&](std::size_t) {
    {
      const std::lock_guard lock(guard);
      seen.insert(std::this_thread::get_id());
    }
    ++present;
    while (present.load() < 4) std::this_thread::yield();
  });
  EXPECT_EQ(seen.size(), 4U);
}

TEST(TileScheduler, TilesFlushDenormalsAndTheCallerKeepsItsOwnSetting) {
  TileScheduler scheduler(4);
  const unsigned before = _mm_getcsr();
  ASSERT_EQ(before & kFlushBits, 0U);
  std::atomic<int> flushed{0};
  std::atomic<int> sums_to_zero{0};
  scheduler.run(64, [&](std::size_t) {
    if ((_mm_getcsr() & kFlushBits) == kFlushBits) ++flushed;
    volatile float tiny = std::numeric_limits<float>::min();
    if (tiny * 0.5F == 0.0F) ++sums_to_zero;
  });
  EXPECT_EQ(flushed.load(), 64);
  EXPECT_EQ(sums_to_zero.load(), 64);
  EXPECT_EQ(_mm_getcsr(), before);
}

}  // namespace
}  // namespace macula::scheduling
