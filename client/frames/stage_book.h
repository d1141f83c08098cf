// StageBook: collects the stamps of shown frames until they are whole. When a frame left the
// server's send queue is known only from the FrameBegin of the next one, which another thread
// reads; a frame whose successor never came stays without an account and is counted. Thread-safe.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <vector>

#include "client/frames/frame_order.h"
#include "client/frames/stages.h"
#include "shared/net/messages.h"

namespace macula::frames {

struct AccountedFrame {
  FrameId id;
  StageTimes times;
};

class StageBook {
 public:
  /// What `begin` tells about the frame before it.
  void note_begin(const net::FrameBegin& begin);
  /// The first showing of a frame. `clock` is the estimate in force now.
  void note_shown(FrameId id, const net::FrameEnd& end, const ClientStamps& stamps,
                  const net::ClockEstimate& clock);
  /// How many whole accounts the book keeps, the newest: a quarter of an hour at 72 Hz.
  static constexpr std::size_t kMostAccounts = 65536;
  /// Whole accounts in the order they became whole, as far as the book keeps them.
  std::vector<AccountedFrame> accounts() const { return accounts_after(0); }
  /// The same without the first `count` of the run.
  std::vector<AccountedFrame> accounts_after(std::size_t count) const;
  /// All whole accounts of the run, kept or not.
  std::uint64_t accounted() const;
  /// Shown frames whose send queue is not known, now or ever.
  std::uint64_t incomplete() const;

 private:
  struct Shown {
    ServerStamps server;  // without the send queue
    ClientStamps client;
    net::ClockEstimate clock;
  };
  struct Sent {
    FrameId id;
    ServerTime end;
  };
  void join(FrameId id);

  mutable std::mutex mutex_;
  std::map<FrameId, Shown> shown_;  // waiting for their send queue, bounded
  std::uint64_t given_up_ = 0;      // shown, and no longer waited for
  std::deque<Sent> sent_;           // not shown yet, newest last, bounded
  std::deque<AccountedFrame> accounts_;
  std::uint64_t left_out_ = 0;  // older accounts, no longer kept
};

}  // namespace macula::frames
