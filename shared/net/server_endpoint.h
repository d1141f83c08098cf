// The server's end of the wire: one ROUTER socket, CURVE and ZAP (fail closed), owned by one net
// thread that sleeps in poll, stamps on wake-up and answers Pings at once. Everything else is
// events out and messages in; all public members are thread-safe.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "shared/base/clock.h"
#include "shared/base/result.h"
#include "shared/base/strong_id.h"
#include "shared/net/messages.h"

namespace macula::net {

/// One connection of one authenticated client; a reconnect is a new PeerId.
using PeerId = base::StrongId<struct PeerTag>;

struct HelloReceived {
  PeerId peer;
  std::string client_key_z85;  ///< authenticated by CURVE, exact
  Hello hello;
  ServerTime received;
};
/// The newest view of a peer (older ones not yet taken are replaced) and its acks. `view` is absent
/// when the message failed check_view_state or only acks came; acks are taken first from every
/// message.
struct ViewReceived {
  PeerId peer;
  std::optional<ViewState> view;
  Acks acks;
  ServerTime received;  ///< when the net thread woke for `view` (or for the acks)
};
struct SettingsReceived {
  PeerId peer;
  Settings settings;
};
struct ByeReceived {
  PeerId peer;
  Bye bye;
};
/// The outcome of send_frame: the send_queue stage, or a frame lost to EAGAIN / EHOSTUNREACH.
struct FrameSent {
  PeerId peer;
  std::uint32_t epoch = 0;
  std::uint64_t frame = 0;
  ServerTime begin, end;
  bool lost = false;
};
using ServerEvent =
    std::variant<HelloReceived, ViewReceived, SettingsReceived, ByeReceived, FrameSent>;

struct ServerCounters {
  std::uint64_t refused_handshakes = 0, malformed = 0, rejected_views = 0, views = 0,
                frames_sent = 0, frames_lost = 0, socket_remakes = 0;
};

/// Delays for tests that show where time goes; zero in production.
struct ServerDelays {
  Nanoseconds send_queue{0};  ///< before a frame's first byte, inside the send_queue stage
  Nanoseconds downlink{0};    ///< after send_queue ended, before the bytes leave; Pongs pass
};

struct ServerEndpointOptions {
  std::string bind = "tcp://127.0.0.1:7788";  ///< port 0 or * picks a free one
  std::string key_folder;
  std::string zap_domain = "macula";
  Limits limits;
  /// A connection over which nothing comes for so long is closed. Clients are never silent for
  /// longer than half a second, and libzmq ends a handshake after two.
  std::chrono::milliseconds most_silence{15'000};
  ServerDelays delays;
};

class ServerEndpoint {
 public:
  /// Errors: no keys, address in use (names the port and the remedy), ZAP handler could not start.
  static Result<std::unique_ptr<ServerEndpoint>> create(const ServerEndpointOptions& options,
                                                        const base::Clock& clock);
  virtual ~ServerEndpoint() = default;

  virtual std::string endpoint() const = 0;  ///< with the actual port
  virtual std::string public_key_z85() const = 0;
  /// Next event, or nullopt after `timeout`.
  virtual std::optional<ServerEvent> wait(Nanoseconds timeout) = 0;
  /// Welcome, Refusal, Bye.
  virtual void send(PeerId peer, Message message) = 0;
  /// Hands a frame over; a FrameSent event follows. Payloads are not copied.
  virtual void send_frame(PeerId peer, EncodedFrame frame) = 0;
  virtual ServerCounters counters() const = 0;
};

}  // namespace macula::net
