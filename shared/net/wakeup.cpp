#include "shared/net/wakeup.h"

#include <sys/eventfd.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <utility>

#include "shared/base/check.h"

namespace macula::net {

Fd::Fd(Fd&& other) noexcept : fd_(other.release()) {}

Fd& Fd::operator=(Fd&& other) noexcept {
  std::swap(fd_, other.fd_);
  return *this;
}

Fd::~Fd() {
  if (fd_ >= 0) ::close(fd_);
}

int Fd::release() {
  return std::exchange(fd_, -1);
}

Wakeup::Wakeup() : event_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  MACULA_CHECK(event_.valid(), "no file descriptor left for an eventfd");
}

void Wakeup::signal() {
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = ::write(event_.value(), &one, sizeof one);
}

void Wakeup::drain() {
  std::uint64_t count = 0;
  [[maybe_unused]] const ssize_t read = ::read(event_.value(), &count, sizeof count);
}

DeadlineTimer::DeadlineTimer()
    : timer_(::timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC)) {
  MACULA_CHECK(timer_.valid(), "no file descriptor left for a timerfd");
}

void DeadlineTimer::arm(SteadyTime deadline) {
  // steady_clock is CLOCK_MONOTONIC on Linux. A zero value would disarm, so the least is 1 ns.
  const auto ns = std::max<std::int64_t>(
      1, std::chrono::duration_cast<std::chrono::nanoseconds>(deadline.time_since_epoch()).count());
  itimerspec when{};
  when.it_value.tv_sec = ns / 1'000'000'000;
  when.it_value.tv_nsec = ns % 1'000'000'000;
  ::timerfd_settime(timer_.value(), TFD_TIMER_ABSTIME, &when, nullptr);
}

}  // namespace macula::net
