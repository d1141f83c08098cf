// Clock offset between client and server from four-stamp exchanges. Keeps the lowest-RTT samples of
// a window; the bound is RTT_min / 2 + 500 ppm x the sample's age, and a sample outside the bound
// (suspend, restart) resets the estimator. A value: the net thread updates, others read copies.
#pragma once

#include <deque>
#include <optional>

#include "shared/units/time.h"

namespace macula::net {

struct ClockEstimate {
  Nanoseconds server_minus_client{0};
  Nanoseconds bound{0};  ///< |error of server_minus_client| is at most this on any link
  Nanoseconds min_rtt{0};

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
  void reset() { samples_.clear(); }
  int resets() const { return resets_; }
  int refused() const { return refused_; }

 private:
  struct Kept {
    Nanoseconds offset, rtt;
    ClientTime at;
  };
  std::deque<Kept> samples_;
  int resets_ = 0, refused_ = 0;
};

}  // namespace macula::net
