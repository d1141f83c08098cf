#include "shared/net/clock_sync.h"

#include <algorithm>
#include <cmath>

namespace macula::net {
namespace {

/// Two quartz clocks differ by less than this; the bound grows by it while a sample ages.
constexpr std::int64_t kSkew_ppm = 500;
constexpr std::size_t kMostSamples = 256;
/// What a line is laid through to learn the skew, and the least of it: 0.2 ms of noise over 8 s are
/// 25 ppm, a twentieth of what is allowed for.
constexpr std::size_t kMostSeconds = 64;
constexpr Nanoseconds kLeastSpan = std::chrono::seconds{8};
constexpr double kStampNoise_s = 0.2e-3;

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
  // A sample that allows all that a newer one does has nothing left to say.
  std::erase_if(samples_, [&](const Kept& older) {
    const Nanoseconds slack = older.rtt / 2 + drift_over(kept.at - older.at) - rtt / 2;
    return std::chrono::abs(kept.offset - older.offset) <= slack;
  });
  samples_.push_back(kept);
  if (samples_.size() > kMostSamples) samples_.pop_front();
  remember_second(kept);
}

void ClockSync::reset() {
  samples_.clear();
  seconds_.clear();
}

void ClockSync::remember_second(const Kept& kept) {
  if (!seconds_.empty() && kept.at - seconds_.back().at < std::chrono::seconds{1}) {
    if (kept.rtt < seconds_.back().rtt) {
      seconds_.back() = {kept.offset, kept.rtt, seconds_.back().at};
    }
    return;
  }
  seconds_.push_back(kept);
  if (seconds_.size() > kMostSeconds) seconds_.pop_front();
}

// Weighted least squares of offset over time. What a round trip took beyond the least one is how
// far its two ways may differ from the others', so that is a sample's noise.
double ClockSync::skew() const {
  if (seconds_.size() < 2 || seconds_.back().at - seconds_.front().at < kLeastSpan) return 0.0;
  const auto least = std::min_element(seconds_.begin(), seconds_.end(),
                                      [](const Kept& a, const Kept& b) { return a.rtt < b.rtt; });
  const auto seconds_from_first = [this](const Kept& kept) {
    return units::to_s(kept.at - seconds_.front().at);
  };
  double weights = 0.0, times = 0.0, offsets = 0.0;
  const auto weight = [&](const Kept& kept) {
    const double noise_s = kStampNoise_s + units::to_s(kept.rtt - least->rtt);
    return 1.0 / (noise_s * noise_s);
  };
  const auto offset_s = [this](const Kept& kept) {
    return units::to_s(kept.offset - seconds_.front().offset);
  };
  for (const Kept& kept : seconds_) {
    weights += weight(kept);
    times += weight(kept) * seconds_from_first(kept);
    offsets += weight(kept) * offset_s(kept);
  }
  double across = 0.0, along = 0.0;
  for (const Kept& kept : seconds_) {
    const double t = seconds_from_first(kept) - times / weights;
    across += weight(kept) * t * (offset_s(kept) - offsets / weights);
    along += weight(kept) * t * t;
  }
  constexpr double kMost = 1e-6 * static_cast<double>(kSkew_ppm);
  return std::clamp(across / along, -kMost, kMost);
}

std::optional<ClockEstimate> ClockSync::estimate(ClientTime now) const {
  if (samples_.empty()) return std::nullopt;
  const auto reach_of = [now](const Kept& kept) {
    return kept.rtt / 2 + drift_over(now - kept.at);
  };
  const auto best =
      std::min_element(samples_.begin(), samples_.end(),
                       [&](const Kept& a, const Kept& b) { return reach_of(a) < reach_of(b); });
  Nanoseconds least = best->offset - reach_of(*best), most = best->offset + reach_of(*best);
  for (const Kept& kept : samples_) {
    least = std::max(least, kept.offset - reach_of(kept));
    most = std::min(most, kept.offset + reach_of(kept));
  }
  const double slope = skew();
  const auto carried =
      Nanoseconds{std::llround(slope * static_cast<double>((now - best->at).count()))};
  const Nanoseconds offset =
      least <= most ? std::clamp(best->offset + carried, least, most) : best->offset;
  const Nanoseconds bound =
      least <= most ? std::max(offset - least, most - offset) : reach_of(*best);
  return ClockEstimate{offset, bound, best->rtt, 1e6 * slope};
}

}  // namespace macula::net
