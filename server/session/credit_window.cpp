#include "server/session/credit_window.h"

#include <algorithm>
#include <cmath>

#include "shared/base/check.h"

namespace macula::session {
namespace {
constexpr std::size_t kMostHanded = 16;  // more than any window: older pairs are of no more use
constexpr std::size_t kMostSends = 16;
constexpr Nanoseconds kRateSpan = std::chrono::seconds{1};
}  // namespace

double CreditWindow::sends_per_second(ServerTime now) const {
  const auto recent = std::find_if(sends_.begin(), sends_.end(),
                                   [&](ServerTime at) { return now - at <= kRateSpan; });
  const auto count = std::distance(recent, sends_.end());
  if (count < 2 || sends_.back() <= *recent) return 0.0;
  return static_cast<double>(count - 1) / units::to_s(sends_.back() - *recent);
}

int CreditWindow::window(ServerTime now) const {
  auto least = rtt_.least(now);
  if (!least) return rules_.least_window;
  // Of a full link, frames' own round trips are mostly the frames before them.
  if (ping_rtt_ > Nanoseconds::zero()) least = std::min(*least, ping_rtt_);
  const double frames = std::ceil(sends_per_second(now) * units::to_s(*least)) + 1.0;
  return static_cast<int>(std::clamp(frames, static_cast<double>(rules_.least_window),
                                     static_cast<double>(rules_.most_window)));
}

bool CreditWindow::may_start(ServerTime now) const {
  return unsent() < rules_.most_unsent && unsent() + in_flight() < window(now) + 1;
}

std::uint64_t CreditWindow::start() {
  unsent_.push_back(++last_started_);
  return last_started_;
}

bool CreditWindow::is_unsent(std::uint64_t frame) const {
  return std::find(unsent_.begin(), unsent_.end(), frame) != unsent_.end();
}

void CreditWindow::abandon(std::uint64_t frame) {
  std::erase(unsent_, frame);
}

void CreditWindow::hand_over(std::uint64_t frame, ServerTime now) {
  MACULA_CHECK(is_unsent(frame), "only an unsent frame can be handed over");
  std::erase(unsent_, frame);
  in_flight_.push_back({frame, now});
  handed_.push_back({frame, std::nullopt, std::nullopt});
  if (handed_.size() > kMostHanded) handed_.pop_front();
  sends_.push_back(now);
  if (sends_.size() > kMostSends) sends_.pop_front();
  last_sent_ = std::max(last_sent_, frame);
}

/// What takes longer than the least timeout measures a pause of this machine or of the client, not
/// the network: taken for a round trip, it would keep lost frames in flight for four times as long.
void CreditWindow::pair(Handed& handed, ServerTime now) {
  if (!handed.end || !handed.acknowledged) return;
  const Nanoseconds rtt = *handed.acknowledged - *handed.end;
  if (rtt <= rules_.least_loss_timeout) rtt_.add(rtt, now);
}

void CreditWindow::on_sent(std::uint64_t frame, ServerTime end) {
  const auto handed = std::find_if(handed_.begin(), handed_.end(),
                                   [&](const Handed& h) { return h.frame == frame; });
  if (handed == handed_.end() || handed->end) return;
  handed->end = end;
  pair(*handed, end);
  for (InFlight& flying : in_flight_)
    if (flying.frame == frame) flying.since = std::max(flying.since, end);
}

bool CreditWindow::on_lost(std::uint64_t frame) {
  std::erase_if(handed_, [&](const Handed& h) { return h.frame == frame; });
  return std::erase_if(in_flight_, [&](const InFlight& f) { return f.frame == frame; }) > 0;
}

void CreditWindow::note_progress(const net::Acks& acks, ServerTime received) {
  const bool moved = acks.received > newest_received_ || acks.receiving > receiving_ ||
                     (acks.receiving == receiving_ && acks.receiving_bytes > receiving_bytes_);
  if (!moved) return;
  last_progress_ = received;
  if (acks.receiving >= receiving_) {
    receiving_ = acks.receiving;
    receiving_bytes_ = acks.receiving_bytes;
  }
}

AckVerdict CreditWindow::acknowledge(const net::Acks& acks, ServerTime received) {
  if (acks.received > last_sent_ || acks.receiving > last_sent_) return AckVerdict::AboveLastSent;
  note_progress(acks, received);
  if (acks.least_rtt > Nanoseconds::zero()) ping_rtt_ = acks.least_rtt;
  if (acks.received <= newest_received_) return AckVerdict::Repeated;
  newest_received_ = acks.received;
  std::erase_if(in_flight_, [&](const InFlight& f) { return f.frame <= acks.received; });
  // Only the acknowledged frame itself tells the round trip: older ones may have waited behind it.
  for (Handed& handed : handed_) {
    if (handed.frame != acks.received || handed.acknowledged) continue;
    handed.acknowledged = received;
    pair(handed, received);
  }
  return AckVerdict::Taken;
}

// By the least round trip: a client that was silent acknowledges late, and that says nothing about
// the link. Queues that make round trips longer show as receiving progress.
Nanoseconds CreditWindow::loss_timeout(ServerTime now) const {
  const Nanoseconds rtt = rtt_.least(now).value_or(Nanoseconds::zero());
  return std::max(rules_.least_loss_timeout, rules_.loss_timeout_rtts * rtt);
}

int CreditWindow::expire(ServerTime now) {
  const Nanoseconds timeout = loss_timeout(now);
  return static_cast<int>(std::erase_if(in_flight_, [&](const InFlight& f) {
    return now - std::max(f.since, last_progress_) > timeout;
  }));
}

}  // namespace macula::session
