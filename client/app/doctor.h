// 'macula-client --doctor': what works between this machine and a server, step by step, and what to
// do about what does not.
#pragma once

#include <atomic>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "client/app/client_config.h"
#include "shared/base/clock.h"
#include "shared/net/clock_sync.h"

namespace macula::client_app {

struct Finding {
  enum class Verdict {
    Good,
    Note,  ///< works, but not as well as it might
    Bad,   ///< a client would not run
  };
  Verdict verdict = Verdict::Good;
  std::string subject;  ///< one word
  std::string text;     ///< what was found, and what to do unless it is good
};

/// What a trial of the stream brought.
struct StreamTrial {
  Nanoseconds lasted{0};
  std::uint64_t frames = 0, bytes = 0;
  std::optional<net::ClockEstimate> clock;
};
/// Clock, rate and bandwidth in words. Pure.
std::vector<Finding> judge(const StreamTrial& trial);

/// Examines keys, connection, version, stream, clock and graphics; each finding is printed at once.
/// False when one is bad.
bool run_doctor(const ClientConfig& config, const base::Clock& clock, const std::atomic<bool>& stop,
                std::ostream& out);

}  // namespace macula::client_app
