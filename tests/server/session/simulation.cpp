#include "tests/server/session/simulation.h"

#include <algorithm>
#include <utility>

#include "shared/base/text.h"
#include "shared/net/wire.h"
#include "tests/server/session/session_fixtures.h"

namespace macula::session::test {
namespace {
constexpr double kViewPeriodMs = 1000.0 / 72.0;
constexpr double kClientStepMs = 5.0;
constexpr double kHandshakeMs = 30.0, kReconnectMs = 100.0;
constexpr double kBeatMs = 100.0;
constexpr std::size_t kPayloadBytes = 300;
constexpr double kTickMs = 10.0;
constexpr double kStrangerPeriodMs = 50.0;
constexpr std::uint64_t kStranger = 1'000'000;
}  // namespace

Simulation::Simulation(std::uint64_t seed, const SessionRules& rules) : rules_(rules), seed_(seed) {
  restart_server();
  restart_client();
  client_step();
  stranger_step();
  beat();
}

double Simulation::uniform(double low, double high) {
  const std::uint64_t bits = math::hash_combine(seed_, ++draws_);
  return low + (high - low) * static_cast<double>(math::unit_float(bits));
}

void Simulation::after(double ms, std::function<void()> event) {
  events_.emplace(now_us_ + static_cast<std::int64_t>(ms * 1e3), std::move(event));
}

void Simulation::require(bool holds, const std::string& what) {
  if (!holds && violation_.empty())
    violation_ = base::concat("at ", now_ms(), " ms of seed ", seed_, ": ", what);
}

void Simulation::run_for(double ms) {
  const std::int64_t end = now_us_ + static_cast<std::int64_t>(ms * 1e3);
  while (!events_.empty() && events_.begin()->first <= end) {
    auto node = events_.extract(events_.begin());
    now_us_ = node.key();
    node.mapped()();
  }
  now_us_ = end;
}

// ---- network

void Simulation::deliver_loosely(std::function<void()> event) {
  if (chance(faults_.drop)) return;
  if (chance(faults_.duplicate)) after(delay_ms(), event);
  after(delay_ms(), std::move(event));
}

void Simulation::deliver_in_order(double& last_arrival_ms, Loss loss, std::function<void()> event) {
  const bool may_be_lost = loss == Loss::AsFaultsSay;
  if (may_be_lost && chance(faults_.drop)) return;
  last_arrival_ms = std::max(last_arrival_ms, now_ms() + delay_ms());
  const double wait = last_arrival_ms - now_ms();
  if (may_be_lost && chance(faults_.duplicate)) after(wait, event);
  after(wait, std::move(event));
}

// ---- client

net::ClientSession::Surroundings Simulation::surroundings() {
  return {.steady = [this] { return steady(); },
          .stamp = [this] { return ClientTime{std::chrono::microseconds{now_us_}}; },
          .offer =
              [this](const net::Message& message) {
                if (!connected_) return false;
                if (chance(faults_.cut)) {
                  lose_connection();
                  return false;
                }
                const auto arrive = [this, message, peer = peer_] { from_client(peer, message); };
                if (std::holds_alternative<net::Hello>(message)) {
                  deliver_in_order(uplink_arrival_ms_, Loss::None, arrive);
                } else {
                  deliver_loosely(arrive);
                }
                return true;
              },
          .emit =
              [this](const net::ClientEvent& event) {
                const auto* const welcomed = std::get_if<net::Welcomed>(&event);
                if (welcomed != nullptr) epochs_welcomed_.insert(welcomed->welcome.epoch);
              },
          .deliver =
              [this](const net::ReceivedFrame& frame) {
                on_frame(frame);
                return net::ClientSession::Surroundings::Taken::Yes;
              },
          .trust = [] {}};
}

void Simulation::client_step() {
  after(kClientStepMs, [this] { client_step(); });
  if (now_ms() < silent_until_ms_) return;
  for (; !unheard_.empty(); unheard_.pop_front()) unheard_.front()();
  if (now_ms() >= next_view_ms_) {
    next_view_ms_ = now_ms() + kViewPeriodMs;
    client_->see(view(++sequence_, 1));
  }
  if (connected_) client_->talk();
  if (client_->is_deserted(connected_)) connect();
}

void Simulation::connect() {
  connected_ = false;
  ++peer_;
  after(kHandshakeMs + delay_ms(), [this, peer = peer_] {
    if (peer != peer_) return;
    connected_ = true;
    client_->on_connected();
  });
}

void Simulation::lose_connection() {
  connected_ = false;
  ++peer_;
  after(kReconnectMs, [this, peer = peer_] {
    if (peer != peer_) return;
    client_->on_failure({net::LinkFailure::Kind::Lost, "the connection broke"});
    connect();
  });
}

void Simulation::tell_client(const net::Message& message, net::Payload payload) {
  const auto hear = [this, envelope = net::encode_envelope(message), payload = std::move(payload),
                     peer = peer_] {
    if (peer != peer_ || !connected_) return;
    const auto bytes = payload ? std::optional(std::span<const std::byte>(*payload)) : std::nullopt;
    client_->hear(std::as_bytes(std::span(envelope)), bytes,
                  ClientTime{std::chrono::microseconds{now_us_}});
  };
  // What comes while the client's process stands still waits in its sockets.
  const auto arrive = [this, hear] {
    if (now_ms() < silent_until_ms_) {
      unheard_.push_back(hear);
    } else {
      hear();
    }
  };
  const bool is_frame = std::holds_alternative<net::FrameBegin>(message) ||
                        std::holds_alternative<net::SliceHeader>(message) ||
                        std::holds_alternative<net::FrameEnd>(message);
  deliver_in_order(downlink_arrival_ms_, is_frame ? Loss::AsFaultsSay : Loss::None, arrive);
}

void Simulation::stranger_step() {
  net::Acks acks;
  acks.epoch = newest_seen_ ? newest_seen_->first : 0;
  acks.received = newest_seen_ ? newest_seen_->second : 0;
  deliver_loosely([this, acks] {
    to_server(net::ViewReceived{net::PeerId{kStranger}, view(1, 1), acks, now()});
  });
  after(kStrangerPeriodMs, [this] { stranger_step(); });
}

/// What a frame's payload holds: another's would show.
std::vector<std::byte> payload_of(std::uint32_t epoch, std::uint64_t frame) {
  return std::vector<std::byte>(kPayloadBytes,
                                static_cast<std::byte>(math::hash_combine(epoch, frame)));
}

void Simulation::on_frame(const net::ReceivedFrame& frame) {
  const net::FrameBegin& begin = frame.begin;
  require(epochs_welcomed_.contains(begin.epoch), "a frame of an epoch never welcomed");
  require(frame.payloads.size() == 1 && frame.payloads[0] == payload_of(begin.epoch, begin.frame),
          "a torn frame");
  const Seen seen{begin.epoch, begin.frame};
  if (newest_seen_ && newest_seen_->first == seen.first) {
    require(newest_seen_->second < seen.second, "a frame after a newer one");
    require(begin.view_sequence >= shown_view_, "a newer frame shows an older view");
  }
  newest_seen_ = seen;
  shown_view_ = begin.view_sequence;
  ++frames_shown_;
  newest_shown_ms_ = now_ms();
}

void Simulation::restart_client() {
  sequence_ = 0;
  client_ =
      std::make_unique<net::ClientSession>("the server", net::Limits{}, hello(1), surroundings());
  connect();
}

void Simulation::silence_client(double ms) {
  silent_until_ms_ = now_ms() + ms;
}

// ---- the server's end of the wire

void Simulation::from_client(std::uint64_t peer, const net::Message& message) {
  const std::string envelope = net::encode_envelope(message);
  const auto decoded = net::decode_envelope(std::as_bytes(std::span(envelope)));
  require(decoded.has_value(), "the client says what the wire refuses");
  if (!decoded) return;
  const net::PeerId id{peer};
  if (const auto* said = std::get_if<net::Hello>(&*decoded)) {
    to_server(net::HelloReceived{id, "key", *said, now()});
  } else if (const auto* seen = std::get_if<net::ViewState>(&*decoded)) {
    if (!take_acks(peer, seen->acks)) return;
    to_server(net::ViewReceived{id, *seen, seen->acks, now()});
  } else if (const auto* acks = std::get_if<net::Acks>(&*decoded)) {
    if (!take_acks(peer, *acks)) return;
    to_server(net::ViewReceived{id, std::nullopt, *acks, now()});
  } else if (const auto* ping = std::get_if<net::Ping>(&*decoded)) {
    if (peer == peer_) tell_client(net::Pong{ping->sequence, ping->sent, now(), now()});
  }
}

bool Simulation::take_acks(std::uint64_t peer, const net::Acks& acks) {
  const auto sender = senders_.find(peer);
  if (sender == senders_.end()) return true;
  if (!sender->second.may_acknowledge(acks)) return false;
  sender->second.acknowledged(acks, steady());
  return true;
}

void Simulation::beat() {
  if (connected_) tell_client(net::Beat{++beats_, now()});
  after(kBeatMs, [this] { beat(); });
}

void Simulation::send(std::uint64_t peer, const net::Outgoing& out) {
  if (peer != peer_) return;
  const auto message = net::decode_envelope(std::as_bytes(std::span(out.envelope)));
  require(message.has_value(), "the server says what the wire refuses");
  if (message) tell_client(*message, out.payload);
}

// ---- server

void Simulation::restart_server() {
  ++server_generation_;
  table_ = std::make_unique<SessionTable>(
      rules_, ServerOffer{},
      counted_bits(math::hash_combine(seed_, static_cast<std::uint64_t>(server_generation_))));
  rendering_ = false;
  free_jobs_ = 2;
  encoder_free_ms_ = 0.0;
  view_of_.clear();
  senders_.clear();
  stopped_.clear();
  const auto tick = [this, generation = server_generation_](auto&& self) -> void {
    if (generation != server_generation_) return;
    carry_out(table_->tick(now()));
    check_server();
    try_render();
    after(kTickMs, [self] { self(self); });
  };
  tick(tick);
}

void Simulation::to_server(const net::ServerEvent& event) {
  carry_out(table_->handle(event, now()));
  check_server();
  try_render();
}

void Simulation::carry_out(const Actions& actions) {
  for (const SendWelcome& action : all_of<SendWelcome>(actions))
    require(action.peer.value != kStranger, "a stranger was welcomed");
  for (const SendWelcome& action : all_of<SendWelcome>(actions))
    if (action.peer.value == peer_) tell_client(action.welcome);
  for (const SendRefusal& action : all_of<SendRefusal>(actions))
    if (action.peer.value == peer_) tell_client(action.refusal);
  for (const AbandonFrames& action : all_of<AbandonFrames>(actions))
    for (const auto& [key, sequence] : view_of_)
      if (key.session == action.session && key.epoch == action.epoch) stopped_.insert(key);
  for (const ReleaseFrame& action : all_of<ReleaseFrame>(actions)) release(action);
}

/// One view, one slice.
net::EncodedFrame encoded(const FrameKey& key, std::uint64_t view_sequence) {
  net::EncodedFrame frame;
  frame.begin.epoch = frame.end.epoch = key.epoch;
  frame.begin.frame = frame.end.frame = key.frame;
  frame.begin.view_sequence = view_sequence;
  net::FrameView& view = frame.begin.views.emplace_back();
  view.display_fov = small_display().fov;
  static const PixelGrid grid = foveation::make_uniform_grid(small_display());
  view.grid = grid;
  frame.begin.slices.push_back(
      {0, 0, net::PlaneKind::Color, net::SliceCodec::Jpeg, {0, 0, 64, 64}, kPayloadBytes});
  frame.payloads.push_back(
      std::make_shared<const std::vector<std::byte>>(payload_of(key.epoch, key.frame)));
  return frame;
}

void Simulation::release(const ReleaseFrame& action) {
  require(action.peer.value != kStranger, "a stranger got a frame");
  const auto [newest, first] = newest_released_.try_emplace(action.key.epoch, action.key);
  require(first || newest->second.frame < action.key.frame, "frames leave out of order");
  newest->second = action.key;
  const auto later = [this](const net::FrameSent& sent) {
    after(0.2, [this, sent, generation = server_generation_] {
      if (generation == server_generation_) to_server(sent);
    });
  };
  if (chance(faults_.network_lost)) {
    later({action.peer, action.key.epoch, action.key.frame, now(), now(), true});
    return;
  }
  net::FrameSender& sender =
      senders_.try_emplace(action.peer.value, action.peer, net::ServerDelays{}, net::Limits{})
          .first->second;
  sender.add(encoded(action.key, view_of_.at(action.key)), now(), steady());
  std::vector<net::FrameSent> ended;
  sender.progress(
      {steady(), [this] { return now(); }},
      [&](const net::Outgoing& out) {
        send(action.peer.value, out);
        return net::SendOutcome::Sent;
      },
      ended);
  for (const net::FrameSent& sent : ended) later(sent);
}

void Simulation::try_render() {
  if (rendering_ || free_jobs_ == 0) return;
  auto start = table_->next_frame(now());
  if (!start) return;
  rendering_ = true;
  --free_jobs_;
  view_of_[start->key] = start->view.sequence;
  after(uniform(1.0, 30.0), [this, start = *start, generation = server_generation_] {
    if (generation == server_generation_) finish_render(start);
  });
}

void Simulation::finish_render(const StartFrame& start) {
  rendering_ = false;
  if (stopped_.contains(start.key)) {
    table_->on_frame_abandoned(start.key);
    ++free_jobs_;
  } else {
    encoder_free_ms_ = std::max(encoder_free_ms_, now_ms()) + uniform(1.0, 8.0);
    after(encoder_free_ms_ - now_ms(), [this, start, generation = server_generation_] {
      if (generation == server_generation_) finish_encode(start);
    });
  }
  try_render();
}

void Simulation::finish_encode(const StartFrame& start) {
  ++free_jobs_;
  if (table_->expects(start.key)) carry_out(table_->on_frame_ready(start.key, now()));
  check_server();
  try_render();
}

void Simulation::check_server() {
  require(table_->sessions().size() <= 1, "one key holds several sessions");
  for (const auto& [id, session] : table_->sessions()) {
    require(session.credit().in_flight() <= rules_.most_window, "in flight above any window");
    require(session.credit().unsent() <= rules_.most_unsent, "too many unsent frames");
    require(session.counters().most_in_flight_excess <= 0, "in flight above the window");
  }
}

}  // namespace macula::session::test
