// What the net thread has to tell the session, newest wins: a view, Hello, Settings or Bye of a
// peer that nobody took yet is replaced by the next of its kind, so the queue is bounded by peers
// and frames, and never by how fast a client sends. Thread-safe.
#pragma once

#include <optional>

#include "shared/base/mailbox.h"
#include "shared/net/server_endpoint.h"

namespace macula::net {

class ServerEvents {
 public:
  void put(ServerEvent event);
  /// The oldest, or nullopt after `timeout` or close().
  std::optional<ServerEvent> wait(Nanoseconds timeout) { return queue_.wait(timeout); }
  void close() { queue_.close(); }

 private:
  base::WaitingQueue<ServerEvent> queue_;
};

/// `newer` on top of `older`, both of one peer: acks are cumulative, a view stays until a newer one
/// comes.
ViewReceived merge(const ViewReceived& older, ViewReceived newer);

}  // namespace macula::net
