// What a client's session does with each message that arrives.
#include <algorithm>
#include <utility>

#include "shared/base/text.h"
#include "shared/net/client_session.h"
#include "shared/net/client_timing.h"
#include "shared/net/received_bytes.h"
#include "shared/net/wire.h"

namespace macula::net {

using std::chrono::milliseconds;

void ClientSession::hear(std::span<const std::byte> envelope,
                         std::optional<std::span<const std::byte>> payload, ClientTime received) {
  heard_ = around_.steady();
  if (std::exchange(is_stale_, false)) around_.emit(Fresh{});
  counters_.bytes += envelope.size() + (payload ? payload->size() : 0);
  auto decoded = [&] {
    const ReadingReceivedBytes reading;
    return decode_envelope(envelope, limits_);
  }();
  if (decoded) {
    dispatch(std::move(*decoded), payload, received);
    return;
  }
  ++counters_.malformed;
  const auto version = wire_version(envelope);
  if (version && *version != kProtocolVersion) {
    emit_refusal({RefusalCode::VersionMismatch, decoded.error().message()});
  }
}

void ClientSession::dispatch(Message&& message, std::optional<std::span<const std::byte>> payload,
                             ClientTime received) {
  struct Visitor {
    ClientSession& session;
    std::optional<std::span<const std::byte>> payload;
    ClientTime received;
    void operator()(Welcome&& m) { session.on(std::move(m)); }
    void operator()(Refusal&& m) { session.on(std::move(m)); }
    void operator()(Bye&& m) { session.on(std::move(m)); }
    void operator()(Pong&& m) { session.on(m, received); }
    void operator()(Beat&&) { session.on_beat(); }
    void operator()(FrameBegin&& m) { session.on(std::move(m), received); }
    void operator()(SliceHeader&& m) { session.on(m, payload); }
    void operator()(FrameEnd&& m) { session.on(m, received); }
    // What only clients send.
    void operator()(Hello&&) { ++session.counters_.malformed; }
    void operator()(Settings&&) { ++session.counters_.malformed; }
    void operator()(ViewState&&) { ++session.counters_.malformed; }
    void operator()(Acks&&) { ++session.counters_.malformed; }
    void operator()(Ping&&) { ++session.counters_.malformed; }
  };
  std::visit(Visitor{*this, payload, received}, std::move(message));
}

void ClientSession::on(Welcome&& welcome) {
  hello_due_.reset();
  const bool is_new =
      !welcome_ || welcome_->session != welcome.session || welcome_->epoch != welcome.epoch;
  if (!is_new) return;  // the answer to a Hello that was repeated
  around_.trust();
  last_failure_.clear();
  assembler_.start_epoch(welcome.epoch);
  ack_due_.reset();
  hello_.resume_token = welcome.resume_token;
  const bool resumed = std::exchange(last_session_, welcome.session) == welcome.session;
  welcome_ = welcome;
  around_.emit(Welcomed{std::move(welcome), resumed});
}

void ClientSession::on(Refusal&& refusal) {
  const SteadyTime now = around_.steady();
  welcome_.reset();
  switch (refusal.code) {
    case RefusalCode::UnknownSession:
      hello_.resume_token.reset();
      last_session_ = 0;
      assembler_.start_epoch(0);
      sync_.reset();
      quick_pings_ = 0;
      hello_due_ = std::max(now, hello_said_ + kHelloAgainAtLeast);
      break;
    case RefusalCode::ServerFull:
      hello_due_ = now + kAskAgainFull;
      break;
    default:
      hello_due_ = now + kAskAgainRefused;
  }
  emit_refusal(std::move(refusal));
}

void ClientSession::emit_refusal(Refusal refusal) {
  if (refusal.text == last_failure_) return;  // said once, while it lasts
  last_failure_ = refusal.text;
  around_.emit(Refused{std::move(refusal)});
}

void ClientSession::on(Bye&& bye) {
  const SteadyTime now = around_.steady();
  welcome_.reset();
  hello_due_ = now + std::max(kAskAgainFull, milliseconds{bye.retry_after_ms});
  around_.emit(
      Disconnected{base::concat("the server at ", server_, " says goodbye: ", bye.reason)});
}

void ClientSession::on(const Pong& pong, ClientTime received) {
  unanswered_since_.reset();
  if (pong.sequence == 0 || pong.sequence > pings_ || pong.ping_sent > received) {
    ++counters_.malformed;
    return;
  }
  sync_.add({pong.ping_sent, pong.ping_received, pong.pong_sent, received});
}

/// The server sends parts as fast as Beats pass them, so a frame whose parts stay away while Beats
/// come has lost one: damage to a frame's header bytes, which CURVE does not seal, can drop a
/// message without ending the connection.
void ClientSession::on_beat() {
  if (++beats_since_part_ >= kBeatsThatEndAFrame) on_step(assembler_.give_up());
}

void ClientSession::on(FrameBegin&& begin, ClientTime received) {
  beats_since_part_ = 0;
  if (welcome_) on_step(assembler_.begin(std::move(begin), received));
}

void ClientSession::on(const SliceHeader& header,
                       std::optional<std::span<const std::byte>> payload) {
  slice_came_ = around_.steady();
  beats_since_part_ = 0;
  if (!welcome_) return;
  const auto bytes = payload.value_or(std::span<const std::byte>{});
  const auto step = [&] {
    const ReadingReceivedBytes reading;
    return assembler_.slice(header, bytes);
  }();
  on_step(step);
}

void ClientSession::on(const FrameEnd& end, ClientTime received) {
  if (welcome_) on_step(assembler_.end(end, received));
}

void ClientSession::on_step(FrameAssembler::Step step) {
  using Step = FrameAssembler::Step;
  const SteadyTime now = around_.steady();
  if (step == Step::Ignored) return;
  if (step == Step::Advanced) {
    if (!ack_due_) ack_due_ = acked_ + kProgressAckEvery;
    return;
  }
  ack_due_ = now;
  send_acks();
  if (step != Step::Completed) return;
  ++counters_.frames;
  patience_ = kLeastPatience;
  auto frame = assembler_.take();
  if (frame && around_.deliver(std::move(*frame)) == Surroundings::Taken::Overflowed) {
    assembler_.want_key();
  }
}

}  // namespace macula::net
