#include "shared/net/clock_sync.h"

#include <algorithm>
#include <cmath>

namespace macula::net {
namespace {

/// Two quartz clocks differ by less than this; the bound grows by it while a sample ages.
constexpr std::int64_t kSkew_ppm = 500;
constexpr std::size_t kMostSamples = 256;
/// What a line is laid through to learn the skew, and the least of it: half a millisecond of noise
/// over 8 s are 60 ppm, an eighth of what is allowed for.
constexpr std::size_t kMostSeconds = 64;
constexpr Nanoseconds kLeastSpan = std::chrono::seconds{8};

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
  const Nanoseconds reach = rtt / 2 + drift_over(sample.pong_received - sample.ping_sent);
  const Interval allowed = allowed_at(sample.pong_received);
  if (kept.offset + reach < allowed.least || kept.offset - reach > allowed.most) {
    reset();
    ++resets_;
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

/// Never empty: a sample that contradicts the others makes them be forgotten.
ClockSync::Interval ClockSync::allowed_at(ClientTime now) const {
  Interval allowed;
  for (const Kept& kept : samples_) {
    const Nanoseconds reach = kept.rtt / 2 + drift_over(now - kept.at);
    allowed.least = std::max(allowed.least, kept.offset - reach);
    allowed.most = std::min(allowed.most, kept.offset + reach);
  }
  return allowed;
}

void ClockSync::reset() {
  samples_.clear();
  seconds_.clear();
}

void ClockSync::remember_second(const Kept& kept) {
  if (!seconds_.empty() && kept.at - second_began_ < std::chrono::seconds{1}) {
    if (kept.rtt < seconds_.back().rtt) seconds_.back() = kept;
    return;
  }
  second_began_ = kept.at;
  seconds_.push_back(kept);
  if (seconds_.size() > kMostSeconds) seconds_.pop_front();
}

// Least squares of offset over time, through the seconds whose round trip was within a millisecond
// of the least: how the others share theirs between the two ways is not known.
double ClockSync::skew() const {
  constexpr Nanoseconds kAlike = std::chrono::milliseconds{1};
  const auto quickest = quickest_second();
  double count = 0.0, times = 0.0, offsets = 0.0;
  ClientTime first = ClientTime::max(), last = ClientTime::min();
  const auto over_alike = [&](const auto& visit) {
    for (const Kept& kept : seconds_) {
      if (kept.rtt > quickest->rtt + kAlike) continue;
      visit(units::to_s(kept.at - quickest->at), units::to_s(kept.offset - quickest->offset));
      first = std::min(first, kept.at);
      last = std::max(last, kept.at);
    }
  };
  over_alike([&](double t, double offset) {
    count += 1.0;
    times += t;
    offsets += offset;
  });
  if (count < 2.0 || last - first < kLeastSpan) return 0.0;
  double across = 0.0, along = 0.0;
  over_alike([&](double t, double offset) {
    across += (t - times / count) * (offset - offsets / count);
    along += (t - times / count) * (t - times / count);
  });
  constexpr double kMost = 1e-6 * static_cast<double>(kSkew_ppm);
  return std::clamp(across / along, -kMost, kMost);
}

std::deque<ClockSync::Kept>::const_iterator ClockSync::quickest_second() const {
  return std::min_element(seconds_.begin(), seconds_.end(),
                          [](const Kept& a, const Kept& b) { return a.rtt < b.rtt; });
}

// A link that is full for half a minute has only slow Pings, each of which bounds the offset more
// tightly than an old quick one; the quick one is still nearer to the truth.
std::optional<ClockEstimate> ClockSync::estimate(ClientTime now) const {
  if (samples_.empty()) return std::nullopt;
  const Interval allowed = allowed_at(now);
  const auto quickest = quickest_second();
  const double slope = skew();
  const double age_ns = static_cast<double>((now - quickest->at).count());
  const Nanoseconds carried = quickest->offset + Nanoseconds{std::llround(slope * age_ns)};
  const Nanoseconds offset = std::clamp(carried, allowed.least, allowed.most);
  const Nanoseconds bound = std::max(offset - allowed.least, allowed.most - offset);
  return ClockEstimate{offset, bound, quickest->rtt, 1e6 * slope};
}

}  // namespace macula::net
