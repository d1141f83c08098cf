#include "client/app/refresh_clock.h"

#include <algorithm>
#include <thread>

namespace macula::client_app {

RefreshClock::RefreshClock(const base::Clock& clock, double refresh_hz, Pacing pacing)
    : clock_(clock),
      period_(units::from_s(1.0 / refresh_hz)),
      pacing_(pacing),
      start_(ClientTime{clock.now()}) {}

void RefreshClock::sleep_until(ClientTime at) const {
  const Nanoseconds left = at - now();
  if (left > Nanoseconds{0}) std::this_thread::sleep_for(left);
}

Refresh RefreshClock::next() {
  if (pacing_ == Pacing::AsFastAsPossible) {
    const std::uint64_t index = next_++;
    const ClientTime begin = now();
    return {index, begin, begin + period_, boundary(index)};
  }
  // The refresh whose period is running is still worth beginning; those before it are over.
  const auto running =
      static_cast<std::uint64_t>(std::max(now() - start_, Nanoseconds{0}) / period_);
  const std::uint64_t index = std::max(next_, running);
  missed_ += index - next_;
  next_ = index + 1;
  sleep_until(boundary(index));
  const ClientTime begin = now();
  return {index, begin, boundary(index + 1), begin};
}

void RefreshClock::wait_for_display(const Refresh& refresh) const {
  if (pacing_ == Pacing::AsFastAsPossible) return;
  const Nanoseconds late = now() - refresh.display;
  const auto periods_late = late > Nanoseconds{0} ? (late + period_ - Nanoseconds{1}) / period_ : 0;
  sleep_until(refresh.display + periods_late * period_);
}

}  // namespace macula::client_app
