// Hand-over between threads. Mailbox holds the newest value only: putting replaces what nobody
// took. Channel is a bounded FIFO: putting into a full one fails at once, it never blocks the
// producer. WaitingQueue is what both it and queues with rules of their own are made of.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

namespace macula::base {

template <class T>
class Mailbox {
 public:
  void put(T value) {
    {
      std::lock_guard lock(mutex_);
      value_ = std::move(value);
    }
    arrived_.notify_one();
  }
  std::optional<T> take() {
    std::lock_guard lock(mutex_);
    return std::exchange(value_, std::nullopt);
  }
  /// Waits up to `timeout` for a value; nullopt on time-out or after close().
  std::optional<T> wait(std::chrono::nanoseconds timeout) {
    std::unique_lock lock(mutex_);
    arrived_.wait_for(lock, timeout, [this] { return value_.has_value() || closed_; });
    return std::exchange(value_, std::nullopt);
  }
  void close() {
    {
      std::lock_guard lock(mutex_);
      closed_ = true;
    }
    arrived_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::optional<T> value_;
  bool closed_ = false;
};

/// A queue whose rule of what a newcomer does to those that wait is the caller's.
template <class T>
class WaitingQueue {
 public:
  /// `rule(waiting, closed)` changes the std::deque of what waits, oldest first; what it returns is
  /// handed on. Wakes one who waits.
  template <class Rule>
  auto change(Rule&& rule) {
    const auto outcome = [&] {
      std::lock_guard lock(mutex_);
      return rule(values_, closed_);
    }();
    arrived_.notify_one();
    return outcome;
  }
  /// The oldest, or nullopt after `timeout` or close().
  std::optional<T> wait(std::chrono::nanoseconds timeout) {
    std::unique_lock lock(mutex_);
    arrived_.wait_for(lock, timeout, [this] { return !values_.empty() || closed_; });
    if (values_.empty()) return std::nullopt;
    std::optional<T> value(std::move(values_.front()));
    values_.pop_front();
    return value;
  }
  /// Wakes everyone who waits, for good. What is in may still be taken.
  void close() {
    {
      std::lock_guard lock(mutex_);
      closed_ = true;
    }
    arrived_.notify_all();
  }
  bool closed() const {
    std::lock_guard lock(mutex_);
    return closed_;
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<T> values_;
  bool closed_ = false;
};

template <class T>
class Channel {
 public:
  explicit Channel(std::size_t capacity) : capacity_(capacity) {}

  /// False when full or closed; the value is then dropped and the caller accounts for it.
  [[nodiscard]] bool put(T value) {
    return queue_.change([&](std::deque<T>& waiting, bool closed) {
      if (closed || waiting.size() >= capacity_) return false;
      waiting.push_back(std::move(value));
      return true;
    });
  }
  std::optional<T> take() { return wait(std::chrono::nanoseconds{0}); }
  std::optional<T> wait(std::chrono::nanoseconds timeout) { return queue_.wait(timeout); }
  void close() { queue_.close(); }
  bool closed() const { return queue_.closed(); }

 private:
  const std::size_t capacity_;
  WaitingQueue<T> queue_;
};

}  // namespace macula::base
