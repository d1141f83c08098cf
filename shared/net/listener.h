// The listening socket, made by us rather than by libzmq: it names the owner's remedy when the port
// is taken, and carries TCP_NOTSENT_LOWAT, which accepted sockets inherit, so that the kernel holds
// little of a frame that a Pong must overtake.
#pragma once

#include <string>

#include "shared/base/result.h"
#include "shared/net/wakeup.h"

namespace macula::net {

struct Listener {
  Fd fd;
  std::string endpoint;  ///< "tcp://ADDRESS:PORT" with the actual port
};

/// `bind`: tcp://A.B.C.D:PORT, tcp://[V6]:PORT or tcp://*:PORT; port 0 or * picks a free one.
Result<Listener> listen_on(const std::string& bind);

/// Whether other machines can reach what listens on this endpoint of a Listener.
bool is_beyond_loopback(const std::string& endpoint);

}  // namespace macula::net
