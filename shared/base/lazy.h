// Lazy: a value that is made when somebody first asks for it, by whichever thread that is; the
// others wait for it. What many frames never ask for costs them nothing.
#pragma once

#include <atomic>
#include <mutex>

namespace macula::base {

template <class T>
class Lazy {
 public:
  Lazy() = default;
  /// A copy is still to be made: what it would be made from is another owner's.
  Lazy(const Lazy& /*other*/) {}
  Lazy& operator=(const Lazy& /*other*/) {
    reset();
    return *this;
  }

  /// It will be made again, in the memory it has. Not while anybody reads it.
  void reset() { made_.store(false, std::memory_order_relaxed); }
  /// `make(T&)` fills what the last value, if any, has left.
  template <class Make>
  const T& get(const Make& make) const {
    if (!made_.load(std::memory_order_acquire)) {
      const std::lock_guard lock(mutex_);
      if (!made_.load(std::memory_order_relaxed)) {
        make(value_);
        made_.store(true, std::memory_order_release);
      }
    }
    return value_;
  }

 private:
  mutable std::mutex mutex_;
  mutable std::atomic<bool> made_{false};
  mutable T value_{};
};

}  // namespace macula::base
