#include "shared/net/zmq_socket.h"

#include <poll.h>

#include <atomic>
#include <cstring>
#include <vector>

#include "shared/base/check.h"
#include "shared/base/text.h"

#ifdef __SANITIZE_THREAD__
extern "C" {
void AnnotateIgnoreReadsBegin(const char* file, int line);
void AnnotateIgnoreReadsEnd(const char* file, int line);
}
#endif

namespace macula::net {
namespace {

// ZMTP heartbeats stay off. In libzmq 4.3.4 an engine whose input has stopped (a full queue is
// enough) and whose peer then closes meets an assertion at the next heartbeat: the whole process
// aborts. The application's Pings and Beats tell who is alive, the server ends connections that
// stay silent, and TCP gives up on data that nobody acknowledges.
constexpr int kHeartbeat_ms = 0;
constexpr int kUnacknowledged_ms = 5000;
constexpr int kHandshake_ms = 2000;
constexpr int kConnectTimeout_ms = 800;
constexpr int kReconnect_ms = 100;
constexpr int kReconnectMost_ms = 1000;
/// Messages queued inside libzmq per peer. The net thread keeps the rest of a frame, so that a Pong
/// never waits behind more than this many parts.
constexpr int kSendQueueMessages = 4;
constexpr int kReceiveQueueMessages = 256;
/// CURVE adds 33 bytes to a part (zmq_curve(7)).
constexpr std::size_t kCurveOverheadBytes = 64;

int zmq_kind(SocketKind kind) {
  switch (kind) {
    case SocketKind::Router:
      return ZMQ_ROUTER;
    case SocketKind::Dealer:
      return ZMQ_DEALER;
    case SocketKind::Rep:
      return ZMQ_REP;
    case SocketKind::Pair:
      return ZMQ_PAIR;
  }
  return ZMQ_PAIR;
}

void release_payload(void*, void* payload) {
  delete static_cast<Payload*>(payload);
}

SendOutcome outcome_of_failure() {
  return zmq_errno() == EAGAIN ? SendOutcome::Full : SendOutcome::Unreachable;
}

/// Parts after the first always fit: libzmq admits whole messages.
SendOutcome send_part(void* socket, Part&& part, int flags) {
  if (zmq_msg_send(part.handle(), socket, flags | ZMQ_DONTWAIT) >= 0) return SendOutcome::Sent;
  return outcome_of_failure();
}

}  // namespace

Context::Context() : context_(zmq_ctx_new()) {
  MACULA_CHECK(context_ != nullptr, "libzmq gives no context");
}

Context::~Context() {
  while (zmq_ctx_term(context_) != 0 && zmq_errno() == EINTR) {
  }
}

Part::Part(std::string_view bytes) {
  MACULA_CHECK(zmq_msg_init_size(&message_, bytes.size()) == 0, "out of memory");
  if (!bytes.empty()) std::memcpy(zmq_msg_data(&message_), bytes.data(), bytes.size());
}

Part::Part(Payload payload, std::size_t offset, std::size_t size) {
  MACULA_CHECK(offset + size <= payload->size(), "a part inside its payload");
  // libzmq only reads; its interface has no const.
  auto* const data = const_cast<std::byte*>(payload->data() + offset);
  auto* const owner = new Payload(std::move(payload));
  MACULA_CHECK(zmq_msg_init_data(&message_, data, size, release_payload, owner) == 0,
               "out of memory");
}

std::span<const std::byte> Part::bytes() const {
  return {static_cast<const std::byte*>(zmq_msg_data(&message_)), zmq_msg_size(&message_)};
}

std::string_view Part::text() const {
  return {static_cast<const char*>(zmq_msg_data(&message_)), zmq_msg_size(&message_)};
}

std::string Part::user_id() const {
  const char* const id = zmq_msg_gets(&message_, "User-Id");
  return id == nullptr ? std::string{} : std::string{id};
}

Socket::Socket(const Context& context, SocketKind kind)
    : socket_(zmq_socket(context.handle(), zmq_kind(kind))) {
  MACULA_CHECK(socket_ != nullptr, "no file descriptor left for a socket");
}

Socket::~Socket() {
  zmq_close(socket_);
}

void Socket::set(int option, int value) {
  MACULA_CHECK(zmq_setsockopt(socket_, option, &value, sizeof value) == 0,
               base::concat("socket option ", option, " = ", value));
}

void Socket::set(int option, const std::string& value) {
  MACULA_CHECK(zmq_setsockopt(socket_, option, value.data(), value.size()) == 0,
               base::concat("socket option ", option));
}

void Socket::set_max_message(std::size_t bytes) {
  const auto most = static_cast<std::int64_t>(bytes);
  MACULA_CHECK(zmq_setsockopt(socket_, ZMQ_MAXMSGSIZE, &most, sizeof most) == 0);
}

Result<void> Socket::bind(const std::string& endpoint) {
  if (zmq_bind(socket_, endpoint.c_str()) == 0) return {};
  return base::runtime_error(zmq_strerror(zmq_errno()), endpoint);
}

Result<void> Socket::connect(const std::string& endpoint) {
  if (zmq_connect(socket_, endpoint.c_str()) == 0) return {};
  return base::bad_input(zmq_strerror(zmq_errno()), endpoint, "tcp://HOST:PORT");
}

SendOutcome Socket::send(const Outgoing& message) {
  const int more = message.payload ? ZMQ_SNDMORE : 0;
  const SendOutcome first = send_part(socket_, Part(message.envelope), more);
  if (first != SendOutcome::Sent || !message.payload) return first;
  return send_part(socket_, Part(message.payload, message.offset, message.size), 0);
}

SendOutcome Socket::send_to(std::string_view routing_id, const Outgoing& message) {
  const SendOutcome admitted = send_part(socket_, Part(routing_id), ZMQ_SNDMORE);
  return admitted == SendOutcome::Sent ? send(message) : admitted;
}

SendOutcome Socket::send_parts(std::span<const std::string> parts) {
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const int more = i + 1 < parts.size() ? ZMQ_SNDMORE : 0;
    const SendOutcome outcome = send_part(socket_, Part(parts[i]), more);
    if (outcome != SendOutcome::Sent) return outcome;
  }
  return SendOutcome::Sent;
}

bool Socket::receive(Incoming& message) {
  message.count = 0;
  for (bool more = true; more; ++message.count) {
    Part excess;
    Part& part = message.count < message.parts.size() ? message.parts[message.count] : excess;
    if (zmq_msg_recv(part.handle(), socket_, ZMQ_DONTWAIT) < 0) return false;
    more = zmq_msg_more(part.handle()) != 0;
  }
  return true;
}

bool Socket::has_input() const {
  int events = 0;
  std::size_t size = sizeof events;
  return zmq_getsockopt(socket_, ZMQ_EVENTS, &events, &size) == 0 && (events & ZMQ_POLLIN) != 0;
}

int Socket::fd() const {
  int fd = -1;
  std::size_t size = sizeof fd;
  MACULA_CHECK(zmq_getsockopt(socket_, ZMQ_FD, &fd, &size) == 0);
  return fd;
}

namespace {

std::string unused_monitor_endpoint() {
  static std::atomic<std::uint64_t> count{0};
  return base::concat("inproc://macula.monitor.", ++count);
}

}  // namespace

Monitor::Monitor(const Context& context, Socket& watched, int events)
    : watched_(watched), events_(context, SocketKind::Pair) {
  const std::string endpoint = unused_monitor_endpoint();
  MACULA_CHECK(zmq_socket_monitor(watched.handle(), endpoint.c_str(), events) == 0);
  events_.set(ZMQ_LINGER, 0);
  MACULA_CHECK(events_.connect(endpoint).has_value());
}

Monitor::~Monitor() {
  zmq_socket_monitor(watched_.handle(), nullptr, 0);
}

std::optional<MonitorEvent> Monitor::next() {
  Incoming message;
  while (events_.receive(message)) {
    const auto bytes = message.parts[0].bytes();
    std::uint16_t event = 0;
    std::int32_t value = 0;
    if (bytes.size() != sizeof event + sizeof value) continue;
    std::memcpy(&event, bytes.data(), sizeof event);
    std::memcpy(&value, bytes.data() + sizeof event, sizeof value);
    return MonitorEvent{event, value};
  }
  return std::nullopt;
}

#ifdef __SANITIZE_THREAD__
ReadingReceivedBytes::ReadingReceivedBytes() {
  AnnotateIgnoreReadsBegin(__FILE__, __LINE__);
}
ReadingReceivedBytes::~ReadingReceivedBytes() {
  AnnotateIgnoreReadsEnd(__FILE__, __LINE__);
}
#else
ReadingReceivedBytes::ReadingReceivedBytes() = default;
ReadingReceivedBytes::~ReadingReceivedBytes() = default;
#endif

void sleep_until_readable(std::span<const int> fds) {
  std::vector<pollfd> polled;
  polled.reserve(fds.size());
  for (const int fd : fds) polled.push_back({fd, POLLIN, 0});
  ::poll(polled.data(), polled.size(), -1);
}

void set_common_options(Socket& socket, const Limits& limits) {
  socket.set(ZMQ_LINGER, 0);
  socket.set(ZMQ_IMMEDIATE, 1);
  socket.set(ZMQ_HANDSHAKE_IVL, kHandshake_ms);
  socket.set(ZMQ_HEARTBEAT_IVL, kHeartbeat_ms);
  socket.set(ZMQ_TCP_MAXRT, kUnacknowledged_ms);
  socket.set(ZMQ_CONNECT_TIMEOUT, kConnectTimeout_ms);
  socket.set(ZMQ_RECONNECT_IVL, kReconnect_ms);
  socket.set(ZMQ_RECONNECT_IVL_MAX, kReconnectMost_ms);
  socket.set(ZMQ_SNDHWM, kSendQueueMessages);
  socket.set(ZMQ_RCVHWM, kReceiveQueueMessages);
  socket.set_max_message(std::max(limits.max_envelope_bytes, limits.max_part_bytes) +
                         kCurveOverheadBytes);
}

}  // namespace macula::net
