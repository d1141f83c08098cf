// Credit, not socket queues, bounds the age of frames. A frame is `unsent` from its start until it
// is handed to the network, then in flight until it is acknowledged, lost or timed out. At most
// window() frames are in flight and one more may be unsent beyond them; window() = clamp(ceil(rate
// x least RTT)
// + 1, 2, 6), where rate is the measured rate of sending and the RTT that of the client's Pings,
// or of frames where that is less. One epoch of one session; pure, not
// thread-safe, bounded memory. Frame ids count from 1.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "server/session/rtt_window.h"
#include "server/session/rules.h"
#include "shared/net/messages.h"

namespace macula::session {

enum class AckVerdict { Taken, Repeated, AboveLastSent };

class CreditWindow {
 public:
  explicit CreditWindow(const SessionRules& rules) : rules_(rules) {}

  /// Frames that may be in flight at once.
  int window(ServerTime now) const;
  int in_flight() const { return static_cast<int>(in_flight_.size()); }
  int unsent() const { return static_cast<int>(unsent_.size()); }
  std::uint64_t last_sent() const { return last_sent_; }

  bool may_start(ServerTime now) const;
  bool may_send(ServerTime now) const { return in_flight() < window(now); }

  /// The next frame id; the frame is unsent from here on.
  std::uint64_t start();
  bool is_unsent(std::uint64_t frame) const;
  /// An unsent frame that will never be sent returns its credit.
  void abandon(std::uint64_t frame);
  /// First byte: the frame is handed to the network now.
  void hand_over(std::uint64_t frame, ServerTime now);
  /// The network sent its last byte.
  void on_sent(std::uint64_t frame, ServerTime end);
  /// The network dropped the frame; false when it was not in flight.
  bool on_lost(std::uint64_t frame);

  AckVerdict acknowledge(const net::Acks& acks, ServerTime received);
  /// Frees what has been in flight too long without progress; returns how many frames were lost.
  int expire(ServerTime now);

  const RttWindow& rtt() const { return rtt_; }

 private:
  struct InFlight {
    std::uint64_t frame = 0;
    ServerTime since{};
  };
  /// Handed over, end of sending or acknowledgement not yet heard: pairs the two into an RTT
  /// sample.
  struct Handed {
    std::uint64_t frame = 0;
    std::optional<ServerTime> end, acknowledged;
  };
  void pair(Handed& handed, ServerTime now);
  void note_progress(const net::Acks& acks, ServerTime received);
  double sends_per_second(ServerTime now) const;
  Nanoseconds loss_timeout(ServerTime now) const;

  SessionRules rules_;
  std::uint64_t last_started_ = 0, last_sent_ = 0, newest_received_ = 0;
  std::vector<std::uint64_t> unsent_;
  std::deque<InFlight> in_flight_;
  std::deque<Handed> handed_;
  std::deque<ServerTime> sends_;
  std::uint64_t receiving_ = 0, receiving_bytes_ = 0;
  ServerTime last_progress_{};
  RttWindow rtt_;
  Nanoseconds ping_rtt_{0};  ///< as the client measures it between frames; 0: not known
};

}  // namespace macula::session
