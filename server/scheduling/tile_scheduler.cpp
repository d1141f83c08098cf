#include "server/scheduling/tile_scheduler.h"

#include <immintrin.h>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <optional>
#include <thread>

#include "server/scheduling/frame_sharing.h"
#include "shared/base/cpu_time.h"

namespace macula::scheduling {
namespace {

/// Flushes denormals on this thread for a scope: a sum that fades out must not run 100 times
/// slower.
class FlushDenormals {
 public:
  FlushDenormals() : before_(_mm_getcsr()) {
    _mm_setcsr(before_ | kFlushToZero | kDenormalsAreZero);
  }
  ~FlushDenormals() { _mm_setcsr(before_); }
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
  static constexpr unsigned kFlushToZero = 0x8000, kDenormalsAreZero = 0x0040;
  unsigned before_;
};

int arena_size(int threads) {
  return threads > 0 ? threads : tbb::task_arena::automatic;
}

/// TBB keeps no more workers than the machine has threads unless told so; the least of all controls
/// alive wins, so one is made only where more are asked for.
std::optional<tbb::global_control> oversubscription(int threads) {
  if (threads <= static_cast<int>(std::thread::hardware_concurrency())) return std::nullopt;
  return std::optional<tbb::global_control>(std::in_place,
                                            tbb::global_control::max_allowed_parallelism,
                                            static_cast<std::size_t>(threads));
}

/// work() on `workers` threads.
template <class Work>
void run_workers(tbb::task_arena& arena, std::size_t workers, const Work& work) {
  arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, workers, 1),
        [&](const tbb::blocked_range<std::size_t>&) { work(); }, tbb::simple_partitioner{});
  });
}

}  // namespace

struct TileScheduler::Arena {
  explicit Arena(int threads) : extra(oversubscription(threads)), tbb(arena_size(threads)) {
    tbb.initialize();
  }
  std::optional<tbb::global_control> extra;
  tbb::task_arena tbb;
};

TileScheduler::TileScheduler(int threads) : arena_(std::make_unique<Arena>(threads)) {}
TileScheduler::~TileScheduler() = default;

int TileScheduler::threads() const {
  return arena_->tbb.max_concurrency();
}

void TileScheduler::set_stop_token(std::stop_token token) {
  stop_ = std::move(token);
}

Outcome TileScheduler::run_erased(std::size_t count, void* context,
                                  void (*body)(void*, std::size_t)) {
  if (sharing_ != nullptr) {
    // A task a thread: each reads the clock, which takes as long as a small tile.
    std::atomic<std::size_t> next{0};
    run_workers(arena_->tbb, std::min(count, static_cast<std::size_t>(threads())), [&] {
      const FlushDenormals flush;
      const double begin_ms = base::thread_cpu_ms();
      for (std::size_t i = next++; i < count; i = next++) body(context, i);
      sharing_->add_body_ms(base::thread_cpu_ms() - begin_ms);
    });
    return Outcome::Completed;
  }
  // Each run reads the token once: a token set meanwhile concerns the next run.
  const std::stop_token stop = stop_;
  std::atomic<bool> left_out{false};
  const auto run_range = [&](const tbb::blocked_range<std::size_t>& range) {
    const FlushDenormals flush;
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      if (stop.stop_requested()) {
        left_out.store(true, std::memory_order_relaxed);
        return;
      }
      body(context, i);
    }
  };
  // One tile a task: tiles are some 0.1 ms to 10 ms of work, a task costs less than a microsecond.
  arena_->tbb.execute([&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 1), run_range,
                      tbb::simple_partitioner{});
  });
  return left_out.load() ? Outcome::Stopped : Outcome::Completed;
}

}  // namespace macula::scheduling
