// What the net thread has to tell the session, newest wins: a view, Hello, Settings or Bye of a
// peer that nobody took yet is replaced by the next of its kind, so the queue is bounded by peers
// and frames, and never by how fast a client sends. Thread-safe.
#pragma once

#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>

#include "shared/net/server_endpoint.h"

namespace macula::net {

class ServerEvents {
 public:
  void put(ServerEvent event);
  /// The oldest, or nullopt after `timeout` or close().
  std::optional<ServerEvent> wait(Nanoseconds timeout);
  void close();

 private:
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<ServerEvent> events_;
  bool closed_ = false;
};

/// `newer` on top of `older`, both of one peer: acks are cumulative, a view stays until a newer one
/// comes.
ViewReceived merge(const ViewReceived& older, ViewReceived newer);

}  // namespace macula::net
