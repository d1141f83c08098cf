// A message on its way to a socket, and what became of it; free of libzmq, so that what decides
// about sending can be tested without a socket.
#pragma once

#include <cstddef>
#include <string_view>

#include "shared/net/messages.h"

namespace macula::net {

/// What leaves as one message: an envelope and perhaps a piece of a payload.
struct Outgoing {
  std::string_view envelope;
  Payload payload;  ///< null: one part only
  std::size_t offset = 0, size = 0;
};

enum class SendOutcome {
  Sent,
  Full,         ///< the queue to this peer has no room now
  Unreachable,  ///< this peer is gone
};

}  // namespace macula::net
