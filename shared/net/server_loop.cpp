#include "shared/net/server_loop.h"

#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <utility>

#include "shared/base/log.h"
#include "shared/base/text.h"
#include "shared/net/listener.h"
#include "shared/net/wire.h"

namespace macula::net {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr milliseconds kBeatEvery{100};
/// A socket with room again normally wakes poll; this covers the wake-ups libzmq swallows.
constexpr milliseconds kRetryEvery{1};
/// A client is never silent for longer than 100 ms, unless it is gone.
constexpr seconds kForgetAfter{10};
/// A key taken out of the allowed folder ends its sessions within this.
constexpr seconds kLookForRevokedEvery{1};
/// One round takes at most this many messages before frames get their turn.
constexpr int kMessagesARound = 256;
constexpr int kGoodbye_ms = 100;

SteadyTime steady_now() {
  return std::chrono::steady_clock::now();
}

// Not ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL: libzmq 4.3.4 tells it between finding a damaged part and
// asking errno what to do about it, and the telling leaves EAGAIN there. The connection is then not
// ended but stops reading for ever, its descriptor and what was queued for it with it.
constexpr int kWatchedEvents = ZMQ_EVENT_ACCEPTED | ZMQ_EVENT_DISCONNECTED;

}  // namespace

ServerLoop::ServerLoop(const ServerEndpointOptions& options, const base::Clock& clock)
    : options_(options),
      clock_(clock),
      zap_(context_, options.key_folder, options.zap_domain),
      connections_(options.most_silence) {}

Result<std::unique_ptr<ServerLoop>> ServerLoop::create(const ServerEndpointOptions& options,
                                                       const base::Clock& clock) {
  const auto keys = load_or_make_keys(options.key_folder, Role::Server);
  if (!keys) return forward(keys);
  std::unique_ptr<ServerLoop> loop(new ServerLoop(options, clock));
  if (auto opened = loop->open(*keys); !opened) return forward(opened);
  return loop;
}

/// The ZAP handler runs before the socket binds: without one, CURVE lets every key in.
Result<void> ServerLoop::open(const KeyPair& keys) {
  if (auto started = zap_.start(); !started) return started;
  auto listener = listen_on(options_.bind);
  if (!listener) return forward(listener);
  endpoint_ = listener->endpoint;
  public_key_ = keys.public_z85;
  router_ = std::make_unique<Socket>(context_, SocketKind::Router);
  monitor_ = std::make_unique<Monitor>(context_, *router_, kWatchedEvents);
  set_common_options(*router_, options_.limits);
  router_->set(ZMQ_ROUTER_MANDATORY, 1);
  router_->set(ZMQ_CURVE_SERVER, 1);
  router_->set(ZMQ_CURVE_SECRETKEY, keys.secret_z85);
  router_->set(ZMQ_ZAP_DOMAIN, options_.zap_domain);
  router_->set(ZMQ_USE_FD, listener->fd.value());
  if (auto bound = router_->bind(endpoint_); !bound) return bound;
  listener->fd.release();  // libzmq closes it with the socket
  return {};
}

/// libzmq reads the end of a connection that was shut down and lets go of it.
void ServerLoop::end_silent_connections() {
  for (const int descriptor : connections_.take_silent(steady_now()))
    ::shutdown(descriptor, SHUT_RDWR);
}

void ServerLoop::run() {
  while (!stopping_) {
    round();
    if (!stopping_) sleep();
  }
  router_->set(ZMQ_LINGER, kGoodbye_ms);  // a Bye just sent may still leave
}

void ServerLoop::round() {
  wakeup_.drain();
  read_monitor();
  end_silent_connections();
  zap_.serve();
  if (zap_.admitted() != handshakes_) read_admitted();  // before the newcomer's first message
  receive_all();
  take_commands();
  beat();
  expel_the_revoked();
  for (auto& [routing_id, peer] : peers_) flush(peer);
  forget_the_gone();
  publish_counters();
}

void ServerLoop::sleep() {
  for (auto& [routing_id, peer] : peers_) {
    if (peer.frames.is_blocked()) flush(peer);
  }
  // libzmq's descriptors are edge-triggered: what is here already would not wake the poll again.
  if (monitor_->has_input() || zap_.has_input() || router_->has_input()) return;
  timer_.arm(next_deadline());
  sleep_until_readable(
      std::array{wakeup_.fd(), timer_.fd(), monitor_->fd(), zap_.fd(), router_->fd()});
}

SteadyTime ServerLoop::next_deadline() const {
  SteadyTime deadline = beat_due_;
  for (const auto& [routing_id, peer] : peers_) {
    if (peer.frames.is_blocked() || !peer.control.empty()) {
      deadline = std::min(deadline, steady_now() + kRetryEvery);
    }
    if (const auto due = peer.frames.deadline(); due && !peer.frames.is_blocked()) {
      deadline = std::min(deadline, *due);
    }
  }
  return deadline;
}

void ServerLoop::read_monitor() {
  while (const auto event = monitor_->next()) connections_.on(*event, steady_now());
}

void ServerLoop::receive_all() {
  for (int i = 0; i < kMessagesARound; ++i) {
    Incoming message;
    if (!router_->receive(message)) return;
    connections_.heard(message.parts[1].connection(), steady_now());
    on_message(message, now());
  }
}

void ServerLoop::take_commands() {
  std::vector<ServerCommand> commands;
  {
    std::lock_guard lock(mutex_);
    commands.swap(commands_);
  }
  for (ServerCommand& command : commands) {
    std::visit([this](auto&& one) { execute(std::move(one)); }, command);
  }
}

void ServerLoop::beat() {
  if (steady_now() < beat_due_) return;
  beat_due_ = steady_now() + kBeatEvery;
  ++beats_;
  for (auto& [routing_id, peer] : peers_) {
    if (peer.control.empty()) peer.control.push_back(Beat{beats_, {}});
  }
}

/// Control first: a Pong or Welcome never waits behind a frame's parts that are still ours.
void ServerLoop::flush(Peer& peer) {
  while (!peer.control.empty()) {
    Message& message = peer.control.front();
    if (auto* const pong = std::get_if<Pong>(&message)) pong->pong_sent = now();
    if (auto* const beat = std::get_if<Beat>(&message)) beat->sent = now();
    const std::string envelope = encode_envelope(message);
    const SendOutcome outcome = router_->send_to(peer.routing_id, {envelope, nullptr, 0, 0});
    if (outcome == SendOutcome::Full) return;
    if (outcome == SendOutcome::Unreachable) peer.is_gone = true;
    peer.control.pop_front();
  }
  std::vector<FrameSent> ended;
  const auto sink = [&](const Outgoing& out) {
    const SendOutcome outcome = router_->send_to(peer.routing_id, out);
    if (outcome == SendOutcome::Unreachable) peer.is_gone = true;
    return outcome;
  };
  peer.frames.progress({steady_now(), [this] { return now(); }}, sink, ended);
  for (const FrameSent& sent : ended) {
    ++(sent.lost ? own_counters_.frames_lost : own_counters_.frames_sent);
    events_.put(sent);
  }
}

void ServerLoop::read_admitted() {
  // Where nothing can be opened any more, those who are in stay in.
  if (auto allowed = allowed_clients(options_.key_folder, TrustOwnClient::Yes))
    admitted_ = std::move(*allowed);
  admitted_read_ = steady_now();
  handshakes_ = zap_.admitted();
}

/// A handshake is checked by the ZAP handler; this is for those that were let in before.
void ServerLoop::expel_the_revoked() {
  if (steady_now() - admitted_read_ < kLookForRevokedEvery) return;
  read_admitted();
  for (auto& [routing_id, peer] : peers_) {
    if (is_admitted(peer.key_z85)) continue;
    refuse(peer, RefusalCode::Unspecified, "the server no longer admits this client's key");
    flush(peer);
    events_.put(ByeReceived{peer.id, {"its key was revoked", 0}});
    peer.is_gone = true;
  }
}

void ServerLoop::forget_the_gone() {
  const SteadyTime now_steady = steady_now();
  for (auto it = peers_.begin(); it != peers_.end();) {
    Peer& peer = it->second;
    if (!peer.is_gone && now_steady - peer.last_heard < kForgetAfter) {
      ++it;
      continue;
    }
    std::vector<FrameSent> ended;
    peer.frames.lose_all(now(), ended);
    own_counters_.frames_lost += ended.size();
    for (const FrameSent& lost : ended) events_.put(lost);
    it = peers_.erase(it);
  }
}

void ServerLoop::publish_counters() {
  // Those the ZAP handler refused end mute as well, only later.
  own_counters_.refused_handshakes = std::max(zap_.refused(), connections_.ended_mute());
  std::lock_guard lock(mutex_);
  published_counters_ = own_counters_;
}

void ServerLoop::post(ServerCommand command) {
  {
    std::lock_guard lock(mutex_);
    commands_.push_back(std::move(command));
  }
  wakeup_.signal();
}

ServerCounters ServerLoop::counters() const {
  std::lock_guard lock(mutex_);
  return published_counters_;
}

ServerLoop::Peer* ServerLoop::find(PeerId id) {
  const auto found = std::find_if(peers_.begin(), peers_.end(),
                                  [id](const auto& entry) { return entry.second.id == id; });
  return found == peers_.end() ? nullptr : &found->second;
}

void ServerLoop::execute(SendMessage&& command) {
  if (Peer* const peer = find(command.peer)) peer->control.push_back(std::move(command.message));
}

void ServerLoop::execute(SendFrame&& command) {
  const FrameBegin& begin = command.frame.begin;
  Peer* const peer = find(command.peer);
  const auto checked = check_frame_begin(begin, options_.limits);
  if (!checked) base::log_error("a frame is not sent: " + checked.error().message());
  if (peer != nullptr && checked && peer->frames.has_room()) {
    peer->frames.add(std::move(command.frame), command.handed_over, steady_now());
    return;
  }
  ++own_counters_.frames_lost;
  events_.put(FrameSent{command.peer, begin.epoch, begin.frame, command.handed_over, now(), true});
}

}  // namespace macula::net
