// A program that is wrong on purpose: two tiles on two threads write one plain integer. Under the
// thread sanitizer it must be reported; were it silent, the scheduler's annotations would hide
// races.
#include <atomic>
#include <cstdio>

#include "server/scheduling/tile_scheduler.h"

int main() {
  using macula::scheduling::TileScheduler;
  TileScheduler scheduler(2);
  std::atomic<int> begun{0};  // relaxed: orders nothing
  int unprotected = 0;
  scheduler.run(2, [&](std::size_t index) {
    begun.fetch_add(1, std::memory_order_relaxed);
    while (begun.load(std::memory_order_relaxed) < 2) {
    }
    unprotected += static_cast<int>(index) + 1;
  });
  std::printf("%d\n", unprotected);
  return 0;
}
