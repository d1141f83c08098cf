// run_timed: work on a scheduler's threads, and what each part of it cost in processor time. To
// read a thread's CPU clock is a system call (2 us in a virtual machine, as long as a small part):
// it is read every fifth of a millisecond, and the wall clock tells the shares of the parts since.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "server/scheduling/tile_scheduler.h"
#include "shared/base/cpu_time.h"

namespace macula::scheduling {

/// Parts of one thread of run_timed.
class PartTimes {
 public:
  template <class Body>
  void time(std::size_t part, Body&& body) {
    const auto begin = Clock::now();
    body(part);
    const auto end = Clock::now();
    parts_.emplace_back(part, Milliseconds(end - begin).count());
    if (end - since_ > kLongest) settle();
  }
  /// cost(part, milliseconds of processor time) of every part so far.
  template <class Cost>
  void tell(Cost&& cost) {
    settle();
    for (const auto& [part, cost_ms] : parts_) cost(part, cost_ms);
  }

 private:
  using Clock = std::chrono::steady_clock;
  using Milliseconds = std::chrono::duration<double, std::milli>;
  /// What an interruption adds to one part it takes from others of the same while, and no more.
  static constexpr std::chrono::microseconds kLongest{200};

  /// Processor time since the last reading goes to the parts since; what lies between them, and
  /// interruptions there, to none in particular.
  void settle() {
    const double cpu_ms = base::thread_cpu_ms() - since_cpu_ms_;
    double wall_ms = 0.0;
    for (std::size_t i = settled_; i < parts_.size(); ++i) wall_ms += parts_[i].second;
    for (; settled_ < parts_.size(); ++settled_)
      parts_[settled_].second *= wall_ms > 0.0 ? cpu_ms / wall_ms : 0.0;
    since_ = Clock::now(), since_cpu_ms_ += cpu_ms;
  }

  double since_cpu_ms_ = base::thread_cpu_ms();
  Clock::time_point since_ = Clock::now();
  std::vector<std::pair<std::size_t, double>> parts_;
  std::size_t settled_ = 0;
};

/// body(part) for every part that take() gives, on every thread until it gives none; then
/// cost(part, milliseconds) by the thread that ran it.
template <class Take, class Body, class Cost>
void run_timed(TileScheduler& scheduler, Take&& take, Body&& body, Cost&& cost) {
  scheduler.run(static_cast<std::size_t>(scheduler.threads()), [&](std::size_t) {
    PartTimes times;
    while (const std::optional<std::size_t> part = take()) times.time(*part, body);
    times.tell(cost);
  });
}

/// 0, 1, ... count - 1, to whoever asks.
class NextPart {
 public:
  explicit NextPart(std::size_t count) : count_(count) {}
  std::optional<std::size_t> operator()() {
    const std::size_t part = next_++;
    return part < count_ ? std::optional(part) : std::nullopt;
  }

 private:
  std::size_t count_;
  std::atomic<std::size_t> next_{0};
};

}  // namespace macula::scheduling
