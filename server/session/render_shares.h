// Who renders next, fair by time and not by frames: start-time fair queueing (Goyal, Vin and Cheng
// 1996, section 2) over one renderer. A session that renders large frames gets as much of the
// renderer's time as one that renders small ones; one that was idle is owed nothing. Pure.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>

#include "shared/units/time.h"

namespace macula::session {

class RenderShares {
 public:
  /// The session with the least tag goes first.
  Nanoseconds start_tag(std::uint64_t session) const {
    const auto known = finish_.find(session);
    return known == finish_.end() ? now_ : std::max(now_, known->second);
  }
  /// The session's frame begins.
  void begin(std::uint64_t session) { finish_[session] = now_ = start_tag(session); }
  /// Its frame took so long.
  void charge(std::uint64_t session, Nanoseconds render) {
    if (const auto known = finish_.find(session); known != finish_.end()) known->second += render;
  }
  void forget(std::uint64_t session) { finish_.erase(session); }

 private:
  Nanoseconds now_{0};  ///< tag of the newest frame begun
  std::map<std::uint64_t, Nanoseconds> finish_;
};

}  // namespace macula::session
