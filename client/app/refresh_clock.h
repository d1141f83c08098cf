// RefreshClock: when refreshes begin and light up, and the time line poses are taken from. In real
// time refresh k begins at start + k periods and lights up one period later; one that is over
// before it could begin is missed. As fast as possible, a refresh begins at once and pose time
// advances by exactly one period each. One thread.
#pragma once

#include <cstdint>

#include "client/app/client_config.h"
#include "shared/base/clock.h"

namespace macula::client_app {

struct Refresh {
  std::uint64_t index = 0;
  ClientTime begin;      ///< real
  ClientTime display;    ///< real, predicted: begin + one period
  ClientTime pose_time;  ///< what pose sources are asked for; equals `begin` in real time
};

class RefreshClock {
 public:
  RefreshClock(const base::Clock& clock, double refresh_hz, Pacing pacing);

  /// The next refresh, as soon as it begins.
  Refresh next();
  /// Until the refresh's picture lights up: its display time, or the first later boundary.
  void wait_for_display(const Refresh& refresh) const;
  std::uint64_t missed() const { return missed_; }

 private:
  ClientTime now() const { return ClientTime{clock_.now()}; }
  ClientTime boundary(std::uint64_t index) const {
    return start_ + static_cast<Nanoseconds::rep>(index) * period_;
  }
  void sleep_until(ClientTime at) const;

  const base::Clock& clock_;
  const Nanoseconds period_;
  const Pacing pacing_;
  const ClientTime start_;
  std::uint64_t next_ = 0, missed_ = 0;
};

}  // namespace macula::client_app
