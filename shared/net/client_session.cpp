#include "shared/net/client_session.h"

#include <algorithm>
#include <utility>

#include "shared/net/client_timing.h"
#include "shared/net/wire.h"

namespace macula::net {

using std::chrono::milliseconds;

ClientSession::ClientSession(std::string server, const Limits& limits, Hello hello,
                             Surroundings around)
    : server_(std::move(server)),
      limits_(limits),
      around_(std::move(around)),
      assembler_(limits),
      hello_(std::move(hello)),
      patience_(kLeastPatience) {}

void ClientSession::on_connected() {
  welcome_.reset();
  messages_.clear();
  assembler_.start_epoch(0);
  sync_.reset();
  ack_due_.reset();
  unanswered_since_.reset();
  quick_pings_ = 0;
  connected_ = around_.steady();
  hello_due_ = connected_;
}

void ClientSession::on_failure(const LinkFailure& failure) {
  welcome_.reset();
  sync_.reset();
  if (failure.text == last_failure_) return;  // said once, while it lasts
  last_failure_ = failure.text;
  if (failure.kind == LinkFailure::Kind::Refused) {
    around_.emit(Refused{{RefusalCode::Unspecified, failure.text}});
  } else {
    around_.emit(Disconnected{failure.text});
  }
}

void ClientSession::see(ViewState view) {
  if (welcome_) view_ = std::move(view);
}

void ClientSession::say(Message message) {
  if (const auto* const settings = std::get_if<Settings>(&message)) hello_.settings = *settings;
  if (welcome_ && messages_.size() < kMostMessages) messages_.push_back(std::move(message));
}

void ClientSession::want_key() {
  assembler_.want_key();
  ack_due_ = around_.steady();
}

void ClientSession::talk() {
  blocked_ = false;
  greet();
  send_ping();
  send_acks();
  send_view();
  send_messages();
}

bool ClientSession::offer(const Message& message) {
  if (around_.offer(message)) return true;
  blocked_ = true;
  return false;
}

void ClientSession::greet() {
  if (!hello_due_ || around_.steady() < *hello_due_) return;
  if (!offer(hello_)) return;
  hello_said_ = around_.steady();
  hello_due_ = hello_said_ + kHelloAgainAfter;
}

void ClientSession::send_messages() {
  while (!messages_.empty() && offer(messages_.front())) messages_.pop_front();
}

void ClientSession::send_view() {
  if (!welcome_) view_.reset();
  if (!view_) return;
  view_->acks = acks_now();
  if (!offer(*view_)) return;
  view_.reset();
  ack_due_.reset();
  acked_ = around_.steady();
  ++counters_.views_sent;
}

void ClientSession::send_acks() {
  if (!welcome_) return;
  const SteadyTime due = std::min(ack_due_.value_or(SteadyTime::max()), acked_ + kAckAgainAfter);
  if (around_.steady() < due) return;
  if (!offer(acks_now())) return;
  ack_due_.reset();
  acked_ = around_.steady();
}

Acks ClientSession::acks_now() const {
  Acks acks = assembler_.acks();
  if (const auto estimate = sync_.estimate(around_.stamp())) acks.least_rtt = estimate->min_rtt;
  return acks;
}

/// Between frames, so that neither Ping nor Pong shares the link with slices; on a link that is
/// never idle now and then anyway.
milliseconds ClientSession::ping_every() const {
  if (assembler_.is_receiving()) return kPingAnywayEvery;
  return quick_pings_ < kQuickPings ? kQuickPingEvery : kPingEvery;
}

void ClientSession::send_ping() {
  const SteadyTime now = around_.steady();
  if (now < pinged_ + ping_every()) return;
  if (!offer(Ping{pings_ + 1, around_.stamp()})) return;
  ++pings_;
  ++quick_pings_;
  pinged_ = now;
  if (!unanswered_since_) unanswered_since_ = now;
}

SteadyTime ClientSession::quiet_since() const {
  SteadyTime quiet = std::max(heard_, connected_);
  // A server that talks but answers no Ping does not hear us; slices on the way excuse a late Pong.
  if (unanswered_since_ && !assembler_.is_receiving()) {
    quiet = std::min(quiet, std::max(*unanswered_since_, slice_came_));
  }
  return quiet;
}

bool ClientSession::is_deserted(bool is_connected) {
  const SteadyTime now = around_.steady();
  const bool ever_heard = heard_ != SteadyTime{};
  if (ever_heard && !is_stale_ && now - heard_ >= kStaleAfter) {
    is_stale_ = true;
    around_.emit(Stale{});
  }
  if (!is_connected || now - quiet_since() < patience_) return false;
  patience_ = std::min(2 * patience_, kMostPatience);
  welcome_.reset();
  return true;
}

SteadyTime ClientSession::deadline(bool is_connected) const {
  SteadyTime deadline = around_.steady() + kPingEvery;
  const auto sooner = [&](std::optional<SteadyTime> due) {
    if (due) deadline = std::min(deadline, *due);
  };
  if (!is_connected) return deadline;
  sooner(hello_due_);
  sooner(ack_due_);
  if (!assembler_.is_receiving()) sooner(pinged_ + ping_every());
  if (!is_stale_) sooner(heard_ + kStaleAfter);
  if (blocked_) sooner(around_.steady() + kRetryEvery);
  return deadline;
}

ClientCounters ClientSession::counters() const {
  ClientCounters counters = counters_;
  counters.frames_incomplete = assembler_.incomplete();
  return counters;
}

}  // namespace macula::net
