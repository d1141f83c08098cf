// Server time and client time are different types: each counts nanoseconds on its own machine's
// monotonic clock, and only net::ClockEstimate translates one into the other.
#pragma once

#include <chrono>

namespace macula::units {

using Nanoseconds = std::chrono::nanoseconds;

/// Tags for std::chrono::time_point; they carry no now(), because "now" is an argument
/// (base::Clock).
struct ServerClockTag {
  using duration = Nanoseconds;
  using rep = duration::rep;
  using period = duration::period;
  static constexpr bool is_steady = true;
};
struct ClientClockTag {
  using duration = Nanoseconds;
  using rep = duration::rep;
  using period = duration::period;
  static constexpr bool is_steady = true;
};

using ServerTime = std::chrono::time_point<ServerClockTag, Nanoseconds>;
using ClientTime = std::chrono::time_point<ClientClockTag, Nanoseconds>;

constexpr double to_ms(Nanoseconds duration) {
  return static_cast<double>(duration.count()) * 1e-6;
}
constexpr double to_s(Nanoseconds duration) {
  return static_cast<double>(duration.count()) * 1e-9;
}
constexpr Nanoseconds from_ms(double ms) {
  return Nanoseconds{static_cast<Nanoseconds::rep>(ms * 1e6 + (ms < 0 ? -0.5 : 0.5))};
}
constexpr Nanoseconds from_s(double s) {
  return from_ms(s * 1e3);
}

}  // namespace macula::units

namespace macula {
using units::ClientTime;
using units::Nanoseconds;
using units::ServerTime;
}  // namespace macula
