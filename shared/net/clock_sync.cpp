#include "shared/net/clock_sync.h"

#include <algorithm>

namespace macula::net {
namespace {

/// Two quartz clocks differ by less than this; the bound grows by it while a sample ages.
constexpr std::int64_t kSkew_ppm = 500;
constexpr std::size_t kMostSamples = 256;

Nanoseconds drift_over(Nanoseconds age) {
  return std::max(Nanoseconds{0}, age) * kSkew_ppm / 1'000'000;
}

}  // namespace

// With one-way delays d1, d2 and true offset o, (t2 - t1) = d1 + o and (t3 - t4) = o - d2, so their
// mean is o + (d1 - d2) / 2: wrong by at most half the round trip, however the two delays share it.
// Ages count from the Ping, so that drift during the exchange is covered too.
void ClockSync::add(const Sample& sample) {
  const Nanoseconds up =
      sample.ping_received.time_since_epoch() - sample.ping_sent.time_since_epoch();
  const Nanoseconds down =
      sample.pong_sent.time_since_epoch() - sample.pong_received.time_since_epoch();
  const Nanoseconds service = sample.pong_sent - sample.ping_received;
  const Nanoseconds rtt = (sample.pong_received - sample.ping_sent) - service;
  if (service < Nanoseconds{0} || rtt < Nanoseconds{0}) {
    ++refused_;
    return;
  }
  const Kept kept{down + (up - down) / 2, rtt, sample.ping_sent};
  if (const auto known = estimate(sample.pong_received)) {
    const Nanoseconds apart = std::chrono::abs(kept.offset - known->server_minus_client);
    if (apart > known->bound + rtt / 2 + drift_over(sample.pong_received - sample.ping_sent)) {
      reset();
      ++resets_;
    }
  }
  // A sample that a newer one bounds more tightly can never be the best again.
  while (!samples_.empty() &&
         samples_.back().rtt / 2 + drift_over(kept.at - samples_.back().at) >= rtt / 2) {
    samples_.pop_back();
  }
  samples_.push_back(kept);
  if (samples_.size() > kMostSamples) samples_.pop_front();
}

std::optional<ClockEstimate> ClockSync::estimate(ClientTime now) const {
  const auto bound_of = [now](const Kept& kept) {
    return kept.rtt / 2 + drift_over(now - kept.at);
  };
  const auto best =
      std::min_element(samples_.begin(), samples_.end(),
                       [&](const Kept& a, const Kept& b) { return bound_of(a) < bound_of(b); });
  if (best == samples_.end()) return std::nullopt;
  return ClockEstimate{best->offset, bound_of(*best), best->rtt};
}

}  // namespace macula::net
