// Where "now" comes from, so that tests and simulations can turn the hands themselves.
#pragma once

#include <atomic>
#include <chrono>

namespace macula::base {

class Clock {
 public:
  virtual ~Clock() = default;
  /// Monotonic; the origin is arbitrary but fixed for the life of the process. Thread-safe.
  virtual std::chrono::nanoseconds now() const = 0;
};

class SteadyClock final : public Clock {
 public:
  std::chrono::nanoseconds now() const override {
    return std::chrono::steady_clock::now().time_since_epoch();
  }
};

/// Moves only when told to.
class ManualClock final : public Clock {
 public:
  std::chrono::nanoseconds now() const override { return std::chrono::nanoseconds{now_ns_.load()}; }
  void advance(std::chrono::nanoseconds step) { now_ns_ += step.count(); }

 private:
  std::atomic<std::chrono::nanoseconds::rep> now_ns_{0};
};

}  // namespace macula::base
