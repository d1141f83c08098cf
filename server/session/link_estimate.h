// LinkEstimate: what the link carries, from acknowledged bytes. A frame occupies the link from when
// its first byte can be there (handed over, plus the round trip that Pings measure between frames)
// or from when the frame before was acknowledged, whichever is later, to its own acknowledgement;
// bytes over that time, summed over the last frames, are the rate. A frame still on its way counts
// with what has come of it, so that a link that breaks down is noticed before the frame is through.
// One epoch of one session; pure, not thread-safe, bounded memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "shared/net/messages.h"

namespace macula::session {

class LinkEstimate {
 public:
  /// `bytes` of payload. Frames in order.
  void on_handed_over(std::uint64_t frame, std::size_t bytes, ServerTime now);
  void on_acks(const net::Acks& acks, ServerTime received);

  /// Payload bytes a second; nullopt before the first frame is acknowledged.
  std::optional<double> bytes_per_s() const;
  /// Of Pings, which overtake what waits here; 0: not known.
  Nanoseconds least_rtt() const { return least_rtt_; }

 private:
  struct Flying {
    std::uint64_t frame = 0;
    std::size_t bytes = 0;
    ServerTime handed_over;
  };
  struct Service {
    double bytes = 0.0, seconds = 0.0;
  };
  /// Since when the link has been `flying`'s alone.
  double seconds_on_link(const Flying& flying, ServerTime now) const;
  void remember(const Service& service);

  std::deque<Flying> flying_;
  std::deque<Service> services_;  ///< of frames that arrived, oldest first
  Service on_its_way_;            ///< of the frame now arriving
  ServerTime last_ack_{};
  Nanoseconds least_rtt_{0};
};

}  // namespace macula::session
