#include "shared/net/client_link.h"

#include <algorithm>

namespace macula::net {
namespace {

constexpr int kWatchedEvents = ZMQ_EVENT_CONNECTED | ZMQ_EVENT_CONNECT_RETRIED |
                               ZMQ_EVENT_DISCONNECTED | ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL |
                               ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL |
                               ZMQ_EVENT_HANDSHAKE_FAILED_AUTH | ZMQ_EVENT_HANDSHAKE_SUCCEEDED;

}  // namespace

Result<void> ClientLink::open(SteadyTime now) {
  close();
  reopen_at_.reset();
  phase_ = LinkPhase::Connecting;
  socket_ = std::make_unique<Socket>(context_, SocketKind::Dealer);
  set_common_options(*socket_, options_.limits);
  socket_->set(ZMQ_IPV6, options_.names.endpoint.find('[') != std::string::npos ? 1 : 0);
  socket_->set(ZMQ_CURVE_SERVERKEY, options_.server_key_z85);
  socket_->set(ZMQ_CURVE_PUBLICKEY, options_.keys.public_z85);
  socket_->set(ZMQ_CURVE_SECRETKEY, options_.keys.secret_z85);
  monitor_ = std::make_unique<Monitor>(context_, *socket_, kWatchedEvents);
  auto connected = socket_->connect(options_.names.endpoint);
  if (!connected) fail(now);
  return connected;
}

std::optional<LinkFailure> ClientLink::attend(SteadyTime now) {
  if (reopen_at_ && now >= *reopen_at_) {
    ++remakes_;
    if (const auto opened = open(now); !opened) {
      return LinkFailure{LinkFailure::Kind::Unreachable, opened.error().message()};
    }
  }
  while (monitor_) {
    const auto event = monitor_->next();
    if (!event) break;
    if (event->event == ZMQ_EVENT_CONNECTED) phase_ = LinkPhase::Shaking;
    if (event->event == ZMQ_EVENT_HANDSHAKE_SUCCEEDED) {
      phase_ = LinkPhase::Ready;
      ++connections_;
    }
    if (auto failure = failure_of(*event, phase_, options_.names)) {
      fail(now);
      return failure;
    }
  }
  return std::nullopt;
}

void ClientLink::close() {
  monitor_.reset();
  socket_.reset();
}

void ClientLink::fail(SteadyTime now) {
  close();
  phase_ = LinkPhase::Connecting;
  reopen_at_ = now + back_off_;
  back_off_ = std::min(2 * back_off_, kMostBackOff);
}

void ClientLink::remake(SteadyTime now) {
  close();
  phase_ = LinkPhase::Connecting;
  reopen_at_ = now;
}

void ClientLink::rest_until(SteadyTime then, SteadyTime now) {
  remake(now);
  reopen_at_ = std::max(then, now);
}

SendOutcome ClientLink::send(const Outgoing& message) {
  return socket_ ? socket_->send(message) : SendOutcome::Full;
}

bool ClientLink::has_input() const {
  return (monitor_ && monitor_->has_input()) || (socket_ && socket_->has_input());
}

void ClientLink::linger(std::chrono::milliseconds time) {
  if (socket_) socket_->set(ZMQ_LINGER, static_cast<int>(time.count()));
}

}  // namespace macula::net
