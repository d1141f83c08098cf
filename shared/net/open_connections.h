// Connections that a listening socket holds, counted by its monitor's events. libzmq 4.3.4 keeps
// the descriptor of a connection whose input one damaged byte has stopped: it no longer reads, so
// it never hears that the peer has gone. Such connections can only be told by their number. Pure.
#pragma once

#include <algorithm>
#include <cstddef>
#include <map>

#include "shared/net/wakeup.h"
#include "shared/net/zmq_socket.h"

namespace macula::net {

class OpenConnections {
 public:
  /// A handshake that lasts longer is ended by libzmq, a peer that says nothing for so long is
  /// forgotten: what is older and no peer's leads nowhere.
  static constexpr std::chrono::seconds kSettled{15};

  void on(const MonitorEvent& event, SteadyTime now) {
    if (event.event == ZMQ_EVENT_ACCEPTED) since_[event.value] = now;
    if (event.event == ZMQ_EVENT_DISCONNECTED) since_.erase(event.value);
  }
  /// Those that belong to none of the living peers.
  std::size_t dead(std::size_t peers, SteadyTime now) const {
    const auto settled =
        static_cast<std::size_t>(std::count_if(since_.begin(), since_.end(), [&](const auto& open) {
          return now - open.second >= kSettled;
        }));
    return settled > peers ? settled - peers : 0;
  }
  std::size_t open() const { return since_.size(); }
  void forget_all() { since_.clear(); }

 private:
  std::map<int, SteadyTime> since_;  ///< by descriptor
};

}  // namespace macula::net
