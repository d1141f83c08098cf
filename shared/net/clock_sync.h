// Clock offset and skew between client and server from four-stamp exchanges. Every sample says that
// the offset lies within RTT / 2 + 500 ppm x the sample's age of its own; the estimate is the
// lowest-RTT sample of the last minute carried on by the skew, kept within what all allow, and the
// bound is the farther end of that interval. A sample outside (suspend, restart) resets the
// estimator. A value: the net thread updates, others read copies.
#pragma once

#include <deque>
#include <optional>

#include "shared/units/time.h"

namespace macula::net {

struct ClockEstimate {
  Nanoseconds server_minus_client{0};
  Nanoseconds bound{0};  ///< |error of server_minus_client| is at most this on any link
  Nanoseconds min_rtt{0};
  double skew_ppm = 0.0;  ///< the server's clock runs this much faster; 0 until it can be told

  ClientTime to_client(ServerTime t) const {
    return ClientTime{t.time_since_epoch() - server_minus_client};
  }
  ServerTime to_server(ClientTime t) const {
    return ServerTime{t.time_since_epoch() + server_minus_client};
  }
};

class ClockSync {
 public:
  struct Sample {
    ClientTime ping_sent;
    ServerTime ping_received, pong_sent;
    ClientTime pong_received;
  };
  /// Samples with negative RTT or service time are refused and counted.
  void add(const Sample& sample);
  /// nullopt before the first sample. `now` ages the bound.
  std::optional<ClockEstimate> estimate(ClientTime now) const;
  void reset();
  int resets() const { return resets_; }
  int refused() const { return refused_; }

 private:
  struct Kept {
    Nanoseconds offset, rtt;
    ClientTime at;
  };
  struct Interval {
    Nanoseconds least = Nanoseconds::min(), most = Nanoseconds::max();
  };
  Interval allowed_at(ClientTime now) const;
  void remember_second(const Kept& kept);
  double skew() const;
  /// Only where there is a sample.
  std::deque<Kept>::const_iterator quickest_second() const;

  std::deque<Kept> samples_;  ///< none allows all that a newer one does
  ClientTime second_began_{};
  std::deque<Kept> seconds_;  ///< the lowest RTT of each second, oldest first
  int resets_ = 0, refused_ = 0;
};

}  // namespace macula::net
