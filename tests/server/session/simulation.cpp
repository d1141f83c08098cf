#include "tests/server/session/simulation.h"

#include <algorithm>
#include <utility>

#include "shared/base/text.h"
#include "tests/server/session/session_fixtures.h"

namespace macula::session::test {
namespace {
constexpr double kViewPeriodMs = 1000.0 / 72.0;
constexpr double kHelloRetryMs = 300.0;
constexpr double kTickMs = 10.0;
constexpr double kStrangerPeriodMs = 50.0;
constexpr std::uint64_t kStranger = 1'000'000;
}  // namespace

Simulation::Simulation(std::uint64_t seed, const SessionRules& rules) : rules_(rules), seed_(seed) {
  restart_server();
  client_step();
  stranger_step();
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

void Simulation::deliver_in_order(double& last_arrival_ms, std::function<void()> event) {
  if (chance(faults_.drop)) return;
  last_arrival_ms = std::max(last_arrival_ms, now_ms() + delay_ms());
  const double wait = last_arrival_ms - now_ms();
  if (chance(faults_.duplicate)) after(wait, event);
  after(wait, std::move(event));
}

// ---- client

void Simulation::client_step() {
  if (now_ms() >= silent_until_ms_) {
    if (welcome_)
      send_view();
    else if (now_ms() - hello_sent_ms_ >= kHelloRetryMs)
      say_hello();
  }
  after(kViewPeriodMs, [this] { client_step(); });
}

void Simulation::stranger_step() {
  net::Acks acks;
  acks.epoch = welcome_ ? welcome_->epoch : 0;
  acks.received = received_;
  deliver_loosely([this, acks] {
    to_server(net::ViewReceived{net::PeerId{kStranger}, view(1, 1), acks, now()});
  });
  after(kStrangerPeriodMs, [this] { stranger_step(); });
}

void Simulation::say_hello() {
  hello_sent_ms_ = now_ms();
  net::Hello message = hello(1);
  message.resume_token = token_;
  deliver_in_order(uplink_arrival_ms_, [this, message, peer = peer_] {
    to_server(net::HelloReceived{net::PeerId{peer}, "key", message, now()});
  });
}

void Simulation::send_view() {
  net::Acks acks;
  acks.epoch = welcome_->epoch;
  acks.received = received_;
  const net::ViewState state = view(++sequence_, 1);
  deliver_loosely([this, acks, state, peer = peer_] {
    to_server(net::ViewReceived{net::PeerId{peer}, state, acks, now()});
  });
}

void Simulation::on_welcome(const net::Welcome& welcome) {
  welcome_ = welcome;
  token_ = welcome.resume_token;
  received_ = 0;
  shown_view_ = 0;
}

void Simulation::on_frame(const SentFrame& frame) {
  if (!welcome_ || frame.epoch != welcome_->epoch || frame.frame <= received_) return;
  require(frame.view_sequence >= shown_view_, "a newer frame shows an older view");
  shown_view_ = frame.view_sequence;
  received_ = frame.frame;
  ++frames_shown_;
  newest_shown_ms_ = now_ms();
}

void Simulation::restart_client() {
  ++peer_;
  welcome_.reset();
  token_.reset();
  sequence_ = 0;
  hello_sent_ms_ = -1e9;
}

void Simulation::silence_client(double ms) {
  silent_until_ms_ = now_ms() + ms;
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
    deliver_in_order(downlink_arrival_ms_, [this, action] {
      if (action.peer.value == peer_) on_welcome(action.welcome);
    });
  for (const SendRefusal& action : all_of<SendRefusal>(actions))
    deliver_in_order(downlink_arrival_ms_, [this, action] {
      if (action.peer.value == peer_) welcome_.reset();
    });
  for (const AbandonFrames& action : all_of<AbandonFrames>(actions))
    for (const auto& [key, sequence] : view_of_)
      if (key.session == action.session && key.epoch == action.epoch) stopped_.insert(key);
  for (const ReleaseFrame& action : all_of<ReleaseFrame>(actions)) release(action);
}

void Simulation::release(const ReleaseFrame& action) {
  require(action.peer.value != kStranger, "a stranger got a frame");
  const auto [newest, first] = newest_released_.try_emplace(action.key.epoch, action.key);
  require(first || newest->second.frame < action.key.frame, "frames leave out of order");
  newest->second = action.key;
  const bool lost = chance(faults_.network_lost);
  const SentFrame frame{action.key.epoch, action.key.frame, view_of_.at(action.key)};
  const net::FrameSent sent{action.peer, frame.epoch, frame.frame, now(), now(), lost};
  after(0.2, [this, sent, generation = server_generation_] {
    if (generation == server_generation_) to_server(sent);
  });
  if (!lost && action.peer.value == peer_)
    deliver_loosely([this, frame, peer = peer_] {
      if (peer == peer_) on_frame(frame);
    });
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
