// What a failed connection means to the person in front of it: from the events of a socket's
// monitor to one sentence that says what to do. Pure.
#pragma once

#include <optional>
#include <string>

#include "shared/net/zmq_socket.h"

namespace macula::net {

/// What the sentences speak about.
struct LinkNames {
  std::string endpoint;     ///< where the client connects
  std::string own_public;   ///< file with this client's public key
  std::string server_file;  ///< where the client's idea of the server's key comes from
};

struct LinkFailure {
  /// Refused: somebody answers and says no; waiting does not help, the text says what does.
  enum class Kind { Unreachable, Refused, Lost };
  Kind kind = Kind::Lost;
  std::string text;
  friend bool operator==(const LinkFailure&, const LinkFailure&) = default;
};

/// How far this connection had come.
enum class LinkPhase { Connecting, Shaking, Ready };

/// nullopt for events that are no failure.
std::optional<LinkFailure> failure_of(const MonitorEvent& event, LinkPhase phase,
                                      const LinkNames& names);

}  // namespace macula::net
