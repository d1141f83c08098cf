// libzmq behind types that own what they hold: a context, message parts, sockets that never block,
// and the monitor of a socket. One thread at a time may use a Socket and its Monitor.
#pragma once

#include <zmq.h>

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "shared/base/result.h"
#include "shared/net/messages.h"
#include "shared/net/outgoing.h"
#include "shared/net/received_bytes.h"
#include "shared/net/wakeup.h"

namespace macula::net {

/// One I/O thread; its destructor waits for the sockets' linger time.
class Context {
 public:
  Context();
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
  void* handle() const { return context_; }

 private:
  void* context_;
};

/// One part of a message.
class Part {
 public:
  Part() { zmq_msg_init(&message_); }
  /// A copy of `bytes`.
  explicit Part(std::string_view bytes);
  /// Bytes [offset, offset + size) of `payload`, not copied; the part keeps the payload alive.
  Part(Payload payload, std::size_t offset, std::size_t size);
  Part(const Part&) = delete;
  Part& operator=(const Part&) = delete;
  ~Part() { zmq_msg_close(&message_); }

  std::span<const std::byte> bytes() const;
  std::string_view text() const;
  /// The User-Id that the ZAP handler gave this connection, empty when there was none.
  std::string user_id() const;
  /// Descriptor of the TCP connection it came over, -1 when there is none.
  int connection() const { return zmq_msg_get(&message_, ZMQ_SRCFD); }
  zmq_msg_t* handle() { return &message_; }

 private:
  mutable zmq_msg_t message_;
};

/// A received message; parts beyond the array are thrown away and only counted.
struct Incoming {
  std::array<Part, 3> parts;
  std::size_t count = 0;
};

enum class SocketKind { Router, Dealer, Rep, Pair };

class Socket {
 public:
  Socket(const Context& context, SocketKind kind);
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  ~Socket();

  /// An option libzmq refuses is our bug, or a key or endpoint that was not checked before.
  void set(int option, int value);
  void set(int option, const std::string& value);
  void set_max_message(std::size_t bytes);
  Result<void> bind(const std::string& endpoint);
  Result<void> connect(const std::string& endpoint);

  SendOutcome send(const Outgoing& message);
  /// ROUTER only: to the peer with this routing id.
  SendOutcome send_to(std::string_view routing_id, const Outgoing& message);
  /// All parts of one message that are here already, in order.
  SendOutcome send_parts(std::span<const std::string> parts);
  bool receive(Incoming& message);

  bool has_input() const;
  /// Signals when has_input or room to send may have changed; edge-triggered (zmq_getsockopt,
  /// ZMQ_FD).
  int fd() const;
  void* handle() const { return socket_; }

 private:
  void* socket_;
};

struct MonitorEvent {
  int event = 0;  ///< ZMQ_EVENT_*
  int value = 0;
};

/// Events of one socket, read from the thread that owns the socket.
class Monitor {
 public:
  Monitor(const Context& context, Socket& watched, int events);
  ~Monitor();
  std::optional<MonitorEvent> next();
  bool has_input() const { return events_.has_input(); }
  int fd() const { return events_.fd(); }

 private:
  Socket& watched_;
  Socket events_;
};

/// Sleeps until one of the descriptors is readable.
void sleep_until_readable(std::span<const int> fds);

/// The options both ends share: CURVE comes on top.
void set_common_options(Socket& socket, const Limits& limits);

}  // namespace macula::net
