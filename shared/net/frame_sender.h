// Sends the frames of one peer, in order, as FrameBegin, slices and FrameEnd, as far as the socket
// takes them; the rest waits here and not in the socket, so that Pongs and Beats overtake it. A
// pure state machine over a sink and two clocks' readings; it lives on the net thread.
#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "shared/net/outgoing.h"
#include "shared/net/server_endpoint.h"
#include "shared/net/wakeup.h"

namespace macula::net {

/// Parts stay at this size until a link is seen to carry kFastLink_bytes_per_s (10 Mbit/s).
inline constexpr std::size_t kSlowLinkPartBytes = 32768;
inline constexpr double kFastLink_bytes_per_s = 1.25e6;
/// A frame that the socket takes nothing of for this long is lost.
inline constexpr std::chrono::seconds kNoProgressLimit{5};
/// Frames handed over and not sent; a session's credit keeps far below.
inline constexpr std::size_t kMostFramesWaiting = 16;

class FrameSender {
 public:
  using Sink = std::function<SendOutcome(const Outgoing&)>;
  struct Now {
    SteadyTime steady;
    std::function<ServerTime()> server;
  };

  FrameSender(PeerId peer, const ServerDelays& delays, const Limits& limits)
      : peer_(peer), delays_(delays), limits_(limits) {}

  /// `handed_over` begins the send_queue stage.
  void add(EncodedFrame frame, ServerTime handed_over, SteadyTime now);
  /// Offers what is due until `sink` is full. Appends frames that ended, sent or lost.
  void progress(const Now& now, const Sink& sink, std::vector<FrameSent>& ended);
  /// The peer is gone: every waiting frame is lost.
  void lose_all(ServerTime now, std::vector<FrameSent>& ended);
  /// Learns the link's rate from how long an acknowledged frame took.
  void acknowledged(const Acks& acks, SteadyTime now);

  bool is_blocked() const { return blocked_; }
  bool has_room() const { return frames_.size() < kMostFramesWaiting; }
  /// When progress() has something to do that no socket announces.
  std::optional<SteadyTime> deadline() const;
  /// Whether a frame up to this one was ever handed over: what an ack may name.
  bool may_acknowledge(const Acks& acks) const;
  std::size_t part_bytes() const { return part_bytes_; }

 private:
  enum class Stage { Begin, Slices, End, Done };
  struct Pending {
    EncodedFrame frame;
    ServerTime handed_over;
    SteadyTime due;            ///< no byte leaves before
    SteadyTime last_progress;  ///< when the socket took the newest message, or when it might have
    Stage stage = Stage::Begin;
    bool reported = false;  ///< send_queue has ended; its FrameSent is out
    std::size_t slice = 0, offset = 0;
    std::optional<SteadyTime> first_byte;
  };
  struct Sent {
    std::uint32_t epoch = 0;
    std::uint64_t frame = 0;
    ServerTime begin, end;
    std::optional<SteadyTime> first_byte;
    std::size_t bytes = 0;
  };

  bool is_due(Pending& pending, const Now& now, std::vector<FrameSent>& ended);
  SendOutcome send_next(Pending& pending, const Sink& sink);
  Outgoing next_message(Pending& pending);
  std::string begin_envelope(const Pending& pending) const;
  bool has_sent_grids_of(const FrameBegin& begin) const;
  void advance(Pending& pending);
  void report(Pending& pending, ServerTime now, std::vector<FrameSent>& ended);
  void lose_front(ServerTime now, std::vector<FrameSent>& ended);

  const PeerId peer_;
  const ServerDelays delays_;
  const Limits limits_;
  std::deque<Pending> frames_;
  std::string envelope_;  ///< of the message now offered; empty when it must be made
  std::optional<Sent> last_sent_;
  /// The grids that the peer has, of a frame of that epoch; a frame with the same leaves them out.
  std::vector<PixelGrid> grids_;
  std::uint32_t grids_epoch_ = 0;
  std::uint64_t grids_frame_ = 0;
  std::uint32_t newest_epoch_ = 0;
  std::uint64_t newest_frame_ = 0;
  std::size_t part_bytes_ = kSlowLinkPartBytes;
  bool blocked_ = false;
};

}  // namespace macula::net
