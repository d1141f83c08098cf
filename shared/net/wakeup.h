// What wakes a net thread besides its sockets: a signal from other threads (eventfd) and a deadline
// (timerfd). Wakeup::signal is thread-safe; the rest belongs to the net thread.
#pragma once

#include <chrono>
#include <optional>

namespace macula::net {

/// Deadlines of the net threads run on the steady clock, whatever clock stamps the messages.
using SteadyTime = std::chrono::steady_clock::time_point;

/// A file descriptor with one owner.
class Fd {
 public:
  Fd() = default;
  explicit Fd(int fd) : fd_(fd) {}
  Fd(Fd&& other) noexcept;
  Fd& operator=(Fd&& other) noexcept;
  ~Fd();
  int value() const { return fd_; }
  bool valid() const { return fd_ >= 0; }
  /// Gives the descriptor up to another owner.
  int release();

 private:
  int fd_ = -1;
};

class Wakeup {
 public:
  Wakeup();
  void signal();
  void drain();
  int fd() const { return event_.value(); }

 private:
  Fd event_;
};

class DeadlineTimer {
 public:
  DeadlineTimer();
  /// Readable from `deadline` on; a passed deadline is readable at once.
  void arm(SteadyTime deadline);
  int fd() const { return timer_.value(); }

 private:
  Fd timer_;
};

}  // namespace macula::net
