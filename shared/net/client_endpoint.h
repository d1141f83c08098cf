// The client's end of the wire: one DEALER socket under CURVE, owned by one net thread that says
// Hello after every (re)connection, pings, assembles frames within limits, acks them at once, and
// remakes its socket with backoff when the monitor reports a failed handshake or a protocol error.
// All public members are thread-safe.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "shared/base/clock.h"
#include "shared/base/result.h"
#include "shared/net/clock_sync.h"
#include "shared/net/messages.h"

namespace macula::net {

struct Welcomed {
  Welcome welcome;
  bool resumed = false;  ///< same session as before the connection was lost
};
struct Refused {
  Refusal refusal;  ///< from the server, or made from handshake events: text says what to do
};
/// No beat or frame for 500 ms; ends with the next Fresh.
struct Stale {};
struct Fresh {};
struct Disconnected {
  std::string text;  ///< a sentence for the user
};

/// A complete frame and when its bytes came.
struct ReceivedFrame {
  FrameBegin begin;
  std::vector<std::vector<std::byte>> payloads;  ///< by directory entry
  FrameEnd end;
  ClientTime first_byte, last_byte;
};
using ClientEvent = std::variant<Welcomed, Refused, Stale, Fresh, Disconnected>;

struct ClientCounters {
  std::uint64_t frames = 0, frames_incomplete = 0, malformed = 0, socket_remakes = 0, bytes = 0,
                views_sent = 0;
};

/// Delays for tests that show where time goes; zero in production.
struct ClientDelays {
  Nanoseconds uplink{0};  ///< between publish() and the wire; Pings pass
};

struct ClientEndpointOptions {
  std::string connect = "tcp://127.0.0.1:7788";
  std::string key_folder;
  std::string server_key_z85;  ///< empty: server.pub of key_folder
  Hello hello;
  Limits limits;
  ClientDelays delays;
};

class ClientEndpoint {
 public:
  static Result<std::unique_ptr<ClientEndpoint>> create(const ClientEndpointOptions& options,
                                                        const base::Clock& clock);
  virtual ~ClientEndpoint() = default;

  /// Newest wins; acks are filled in on the way out. Dropped while not welcomed.
  virtual void publish(ViewState view) = 0;
  virtual void send(Message settings_or_bye) = 0;
  /// The next complete frame, or nullopt after `timeout`. Untaken ones are replaced by a newer key
  /// frame and kept before one that leans on them.
  virtual std::optional<ReceivedFrame> wait_frame(Nanoseconds timeout) = 0;
  /// A frame could not be decoded: the server is asked for one that leans on no other.
  virtual void request_key() = 0;
  virtual std::optional<ClientEvent> take_event() = 0;
  /// nullopt before the first Pong of this connection.
  virtual std::optional<ClockEstimate> clock() const = 0;
  virtual ClientCounters counters() const = 0;
};

}  // namespace macula::net
