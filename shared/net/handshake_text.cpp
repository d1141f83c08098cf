#include "shared/net/handshake_text.h"

#include "shared/base/text.h"

namespace macula::net {
namespace {

using base::concat;
using Kind = LinkFailure::Kind;

LinkFailure unknown_client(const LinkNames& names) {
  return {Kind::Refused,
          concat("the server at ", names.endpoint,
                 " does not know this client: run 'macula-server pair' there and "
                 "'macula-client pair' here, or copy ",
                 names.own_public,
                 " to the folder allowed/ of the server's keys, as NAME.pub; no restart is "
                 "needed")};
}

LinkFailure wrong_server_key(const LinkNames& names) {
  return {Kind::Refused,
          concat("the handshake with ", names.endpoint, " failed: its key is not the one in ",
                 names.server_file,
                 ", or it is not a Macula server; pair again ('macula-server pair' there, "
                 "'macula-client pair' here), copy server.pub from the server's key folder there, "
                 "or check --connect")};
}

LinkFailure not_a_server(const LinkNames& names) {
  return {Kind::Refused,
          concat(names.endpoint,
                 " does not speak as a Macula server does: check the address given to --connect")};
}

LinkFailure unreachable(const LinkNames& names) {
  return {Kind::Unreachable,
          concat("no server can be reached at ", names.endpoint,
                 ": start macula-server there, or check --connect and firewalls")};
}

LinkFailure lost(const LinkNames& names) {
  return {Kind::Lost, concat("the connection to ", names.endpoint, " was lost; trying again")};
}

LinkFailure damaged(const LinkNames& names) {
  return {Kind::Lost, concat("bytes from ", names.endpoint, " came damaged; connecting again")};
}

}  // namespace

std::optional<LinkFailure> failure_of(const MonitorEvent& event, LinkPhase phase,
                                      const LinkNames& names) {
  const bool ready = phase == LinkPhase::Ready;
  switch (event.event) {
    case ZMQ_EVENT_HANDSHAKE_FAILED_AUTH:
      return unknown_client(names);
    case ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL:
      if (ready) return damaged(names);
      // Our key or theirs does not open the boxes; other codes are another protocol.
      return event.value == ZMQ_PROTOCOL_ERROR_ZMTP_CRYPTOGRAPHIC ? wrong_server_key(names)
                                                                  : not_a_server(names);
    case ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL:
      return ready ? lost(names) : wrong_server_key(names);
    case ZMQ_EVENT_CONNECT_RETRIED:
      return ready ? lost(names) : unreachable(names);
    case ZMQ_EVENT_DISCONNECTED:
      // Before the handshake's end a disconnect follows from an event that says more, or from a
      // peer that closed on us, as a server does whose key was wrong.
      return ready ? lost(names) : wrong_server_key(names);
    default:
      return std::nullopt;
  }
}

}  // namespace macula::net
