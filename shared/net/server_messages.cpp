// What the server's net thread does with each message that arrives.
#include <algorithm>
#include <utility>

#include "shared/base/text.h"
#include "shared/net/server_loop.h"
#include "shared/net/wire.h"

namespace macula::net {
namespace {

constexpr std::size_t kMostControlWaiting = 64;

std::string version_text(std::uint32_t theirs) {
  return base::concat("this server speaks Macula wire version ", kProtocolVersion,
                      ", the client version ", theirs,
                      ": install the same version on both machines");
}

}  // namespace

ServerLoop::Peer& ServerLoop::peer_of(std::string_view routing_id, const std::string& key_z85) {
  const auto found = peers_.find(std::string(routing_id));
  if (found != peers_.end()) return found->second;
  const PeerId id{++last_peer_};
  Peer peer(id, std::string(routing_id), key_z85,
            FrameSender(id, options_.delays, options_.limits));
  return peers_.emplace(std::string(routing_id), std::move(peer)).first->second;
}

bool ServerLoop::is_admitted(const std::string& key_z85) const {
  return std::find(admitted_.begin(), admitted_.end(), key_z85) != admitted_.end();
}

void ServerLoop::on_message(const Incoming& message, ServerTime received) {
  constexpr std::size_t kParts = 2;  // routing id and envelope
  const std::string key = message.count == kParts ? message.parts[1].user_id() : std::string{};
  if (key.empty()) {  // every admitted connection has a key; anything else fails closed
    ++own_counters_.malformed;
    return;
  }
  if (!is_admitted(key)) {  // revoked after its handshake
    ++own_counters_.malformed;
    return;
  }
  Peer& peer = peer_of(message.parts[0].text(), key);
  peer.last_heard = std::chrono::steady_clock::now();
  const auto bytes = message.parts[1].bytes();
  if (const auto version = wire_version(bytes); version && *version != kProtocolVersion) {
    ++own_counters_.malformed;
    refuse(peer, RefusalCode::VersionMismatch, version_text(*version));
    return;
  }
  auto decoded = [&] {
    const ReadingReceivedBytes reading;
    return decode_envelope(bytes, options_.limits);
  }();
  if (!decoded) {
    on_undecodable(peer, decoded.error());
    return;
  }
  std::visit([&](auto&& body) { on(peer, std::move(body), received); }, *decoded);
}

/// A client that has not been understood yet must learn why; later its damaged messages only count.
void ServerLoop::on_undecodable(Peer& peer, const Error& error) {
  ++own_counters_.malformed;
  if (!peer.has_said_hello) refuse(peer, RefusalCode::BadRequest, error.message());
}

void ServerLoop::refuse(Peer& peer, RefusalCode code, std::string text) {
  if (peer.control.size() < kMostControlWaiting) {
    peer.control.push_back(Refusal{code, std::move(text)});
  }
}

void ServerLoop::on(Peer& peer, Hello&& hello, ServerTime received) {
  if (hello.protocol_version != kProtocolVersion) {
    ++own_counters_.malformed;
    refuse(peer, RefusalCode::VersionMismatch, version_text(hello.protocol_version));
    return;
  }
  peer.has_said_hello = true;
  peer.last_view = 0;
  events_.put(HelloReceived{peer.id, peer.key_z85, std::move(hello), received});
}

/// False when the acks name a frame that was never handed over.
bool ServerLoop::take_acks(Peer& peer, const Acks& acks) {
  if (!peer.frames.may_acknowledge(acks)) {
    ++own_counters_.malformed;
    return false;
  }
  peer.frames.acknowledged(acks, std::chrono::steady_clock::now());
  return true;
}

/// Acks first, whatever becomes of the view.
void ServerLoop::on(Peer& peer, ViewState&& view, ServerTime received) {
  if (!take_acks(peer, view.acks)) return;
  ViewReceived event{peer.id, std::nullopt, view.acks, received};
  if (view.sequence > peer.last_view && check_view_state(view)) {
    peer.last_view = view.sequence;
    ++own_counters_.views;
    event.view = std::move(view);
  } else {
    ++own_counters_.rejected_views;
  }
  events_.put(std::move(event));
}

void ServerLoop::on(Peer& peer, Acks&& acks, ServerTime received) {
  if (take_acks(peer, acks)) events_.put(ViewReceived{peer.id, std::nullopt, acks, received});
}

void ServerLoop::on(Peer& peer, Settings&& settings, ServerTime) {
  events_.put(SettingsReceived{peer.id, std::move(settings)});
}

void ServerLoop::on(Peer& peer, Bye&& bye, ServerTime) {
  events_.put(ByeReceived{peer.id, std::move(bye)});
}

/// Answered before the next message is read.
void ServerLoop::on(Peer& peer, Ping&& ping, ServerTime received) {
  if (peer.control.size() < kMostControlWaiting) {
    peer.control.push_front(Pong{ping.sequence, ping.sent, received, {}});
  }
  flush(peer);
}

void ServerLoop::on_foreign(Peer&) {
  ++own_counters_.malformed;
}

}  // namespace macula::net
