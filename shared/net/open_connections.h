// Connections that a listening socket holds, by the events of its monitor and the messages that
// come. One that says nothing for a while leads nowhere: its peer has vanished behind something
// that keeps the TCP connection alive, or a damaged length has it wait for bytes that never come.
// libzmq would keep its descriptor for ever. Pure.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "shared/net/wakeup.h"
#include "shared/net/zmq_socket.h"

namespace macula::net {

class OpenConnections {
 public:
  explicit OpenConnections(std::chrono::milliseconds most_silence) : most_silence_(most_silence) {}

  void on(const MonitorEvent& event, SteadyTime now) {
    if (event.event == ZMQ_EVENT_ACCEPTED) open_[event.value] = {now, false};
    if (event.event != ZMQ_EVENT_DISCONNECTED) return;
    const auto ended = open_.find(event.value);
    if (ended == open_.end()) return;
    if (!ended->second.has_spoken) ++ended_mute_;
    open_.erase(ended);
  }
  /// A message came over this descriptor.
  void heard(int descriptor, SteadyTime now) {
    const auto speaker = open_.find(descriptor);
    if (speaker != open_.end()) speaker->second = {now, true};
  }
  /// Descriptors of connections that have been silent for too long. Each is named once; again only
  /// when it is still there after as long a time.
  std::vector<int> take_silent(SteadyTime now) {
    std::vector<int> silent;
    for (auto& [descriptor, connection] : open_) {
      if (now - connection.last_heard < most_silence_) continue;
      connection.last_heard = now;
      silent.push_back(descriptor);
    }
    return silent;
  }
  std::size_t open() const { return open_.size(); }
  /// Connections that ended without a message: their handshake was refused or never done.
  std::uint64_t ended_mute() const { return ended_mute_; }

 private:
  struct Connection {
    SteadyTime last_heard;  ///< or when it was accepted
    bool has_spoken = false;
  };
  const std::chrono::milliseconds most_silence_;
  std::map<int, Connection> open_;  ///< by descriptor
  std::uint64_t ended_mute_ = 0;
};

}  // namespace macula::net
