#include "server/session/link_estimate.h"

#include <algorithm>

namespace macula::session {
namespace {

constexpr std::size_t kMostFlying = 32;
/// The rate is a mean over at most so many frames and, where they took long, over so much time.
constexpr std::size_t kMostServices = 12, kLeastServices = 2;
constexpr double kSpan_s = 0.4;
/// Below it the programs' own scheduling is measured, not the link.
constexpr double kLeastService_s = 0.3e-3;

}  // namespace

void LinkEstimate::on_handed_over(std::uint64_t frame, std::size_t bytes, ServerTime now) {
  flying_.push_back({frame, bytes, now});
  if (flying_.size() > kMostFlying) flying_.pop_front();
}

double LinkEstimate::seconds_on_link(const Flying& flying, ServerTime now) const {
  const ServerTime since = std::max(flying.handed_over + least_rtt_, last_ack_);
  return std::max(units::to_s(now - since), kLeastService_s);
}

void LinkEstimate::remember(const Service& service) {
  services_.push_back(service);
  const auto span_s = [this] {
    double sum = 0.0;
    for (const Service& s : services_) sum += s.seconds;
    return sum;
  };
  while (services_.size() > kMostServices ||
         (services_.size() > kLeastServices && span_s() > kSpan_s)) {
    services_.pop_front();
  }
}

void LinkEstimate::on_acks(const net::Acks& acks, ServerTime received) {
  if (acks.least_rtt > Nanoseconds{0}) least_rtt_ = acks.least_rtt;
  bool arrived = false;
  while (!flying_.empty() && flying_.front().frame <= acks.received) {
    // Only the acknowledged frame itself was timed; those before it were discarded or merged.
    const Flying flying = flying_.front();
    flying_.pop_front();
    if (flying.frame != acks.received || flying.bytes == 0) continue;
    remember({static_cast<double>(flying.bytes), seconds_on_link(flying, received)});
    arrived = true;
  }
  if (arrived) {
    last_ack_ = received;
    on_its_way_ = {};
  }
  const bool is_next = !flying_.empty() && flying_.front().frame == acks.receiving;
  if (is_next && acks.receiving_bytes > 0) {
    on_its_way_ = {static_cast<double>(acks.receiving_bytes),
                   seconds_on_link(flying_.front(), received)};
  }
}

std::optional<double> LinkEstimate::bytes_per_s() const {
  double bytes = 0.0, seconds = 0.0;
  for (const Service& service : services_) {
    bytes += service.bytes;
    seconds += service.seconds;
  }
  if (seconds <= 0.0) return std::nullopt;
  const double rate = bytes / seconds;
  if (on_its_way_.seconds <= 0.0) return rate;
  return std::min(rate, (bytes + on_its_way_.bytes) / (seconds + on_its_way_.seconds));
}

}  // namespace macula::session
