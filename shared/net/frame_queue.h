// Complete frames on their way to the decoder. A key frame replaces all that wait, since nothing
// leans on them any more; a frame that leans on others queues behind them, so that every one is
// decoded in order. Bounded: a decoder that falls behind by kMost frames loses them all and has to
// start from a key frame. Thread-safe.
#pragma once

#include <optional>

#include "shared/base/mailbox.h"
#include "shared/net/client_endpoint.h"

namespace macula::net {

class FrameQueue {
 public:
  static constexpr std::size_t kMost = 16;
  enum class Put { Kept, Overflowed };

  /// Overflowed: this frame and all that waited are dropped.
  Put put(ReceivedFrame frame);
  /// The oldest, or nullopt after `timeout` or close().
  std::optional<ReceivedFrame> wait(Nanoseconds timeout) { return queue_.wait(timeout); }
  void close() { queue_.close(); }

 private:
  base::WaitingQueue<ReceivedFrame> queue_;
};

}  // namespace macula::net
