// What the client's net thread does with each message that arrives.
#include <algorithm>
#include <utility>

#include "shared/base/text.h"
#include "shared/net/client_loop.h"
#include "shared/net/wire.h"

namespace macula::net {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kHelloAgainAtLeast{100};
/// A server that is full or of another version is asked again, slowly.
constexpr milliseconds kAskAgainFull{1000}, kAskAgainRefused{5000};
constexpr milliseconds kProgressAckEvery{50};
constexpr milliseconds kLeastPatience{700};
constexpr int kBeatsThatEndAFrame = 5;

SteadyTime steady_now() {
  return std::chrono::steady_clock::now();
}

}  // namespace

void ClientLoop::on_message(const Incoming& message, ClientTime received) {
  heard_ = steady_now();
  if (std::exchange(is_stale_, false)) emit(Fresh{});
  for (std::size_t i = 0; i < std::min(message.count, message.parts.size()); ++i) {
    own_counters_.bytes += message.parts[i].bytes().size();
  }
  const auto part0 = message.parts[0].bytes();
  auto decoded = [&] {
    const ReadingReceivedBytes reading;
    return decode_envelope(part0, options_.limits);
  }();
  if (decoded) {
    dispatch(std::move(*decoded), message, received);
    return;
  }
  ++own_counters_.malformed;
  const auto version = wire_version(part0);
  if (version && *version != kProtocolVersion) {
    emit_refusal({RefusalCode::VersionMismatch, decoded.error().message()});
  }
}

void ClientLoop::dispatch(Message&& message, const Incoming& incoming, ClientTime received) {
  struct Visitor {
    ClientLoop& loop;
    const Incoming& incoming;
    ClientTime received;
    void operator()(Welcome&& m) { loop.on(std::move(m)); }
    void operator()(Refusal&& m) { loop.on(std::move(m)); }
    void operator()(Bye&& m) { loop.on(std::move(m)); }
    void operator()(Pong&& m) { loop.on(m, received); }
    void operator()(Beat&&) { loop.on_beat(); }
    void operator()(FrameBegin&& m) { loop.on(std::move(m), received); }
    void operator()(SliceHeader&& m) { loop.on(m, incoming); }
    void operator()(FrameEnd&& m) { loop.on(m, received); }
    // What only clients send.
    void operator()(Hello&&) { ++loop.own_counters_.malformed; }
    void operator()(Settings&&) { ++loop.own_counters_.malformed; }
    void operator()(ViewState&&) { ++loop.own_counters_.malformed; }
    void operator()(Acks&&) { ++loop.own_counters_.malformed; }
    void operator()(Ping&&) { ++loop.own_counters_.malformed; }
  };
  std::visit(Visitor{*this, incoming, received}, std::move(message));
}

void ClientLoop::on(Welcome&& welcome) {
  hello_due_.reset();
  const bool is_new =
      !welcome_ || welcome_->session != welcome.session || welcome_->epoch != welcome.epoch;
  if (!is_new) return;  // the answer to a Hello that was repeated
  link_.trust();
  last_failure_.clear();
  assembler_.start_epoch(welcome.epoch);
  ack_due_.reset();
  hello_.resume_token = welcome.resume_token;
  const bool resumed = std::exchange(last_session_, welcome.session) == welcome.session;
  welcome_ = welcome;
  emit(Welcomed{std::move(welcome), resumed});
}

void ClientLoop::on(Refusal&& refusal) {
  const SteadyTime now = steady_now();
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

void ClientLoop::emit_refusal(Refusal refusal) {
  if (refusal.text == last_failure_) return;  // said once, while it lasts
  last_failure_ = refusal.text;
  emit(Refused{std::move(refusal)});
}

void ClientLoop::on(Bye&& bye) {
  const SteadyTime now = steady_now();
  welcome_.reset();
  hello_due_ = now + std::max(kAskAgainFull, milliseconds{bye.retry_after_ms});
  emit(Disconnected{
      base::concat("the server at ", options_.connect, " says goodbye: ", bye.reason)});
}

void ClientLoop::on(const Pong& pong, ClientTime received) {
  unanswered_since_.reset();
  if (pong.sequence == 0 || pong.sequence > pings_ || pong.ping_sent > received) {
    ++own_counters_.malformed;
    return;
  }
  sync_.add({pong.ping_sent, pong.ping_received, pong.pong_sent, received});
}

/// The server sends parts as fast as Beats pass them, so a frame whose parts stay away while Beats
/// come has lost one: damage to a frame's header bytes, which CURVE does not seal, can drop a
/// message without ending the connection.
void ClientLoop::on_beat() {
  if (++beats_since_part_ >= kBeatsThatEndAFrame) on_step(assembler_.give_up());
}

void ClientLoop::on(FrameBegin&& begin, ClientTime received) {
  beats_since_part_ = 0;
  if (welcome_) on_step(assembler_.begin(std::move(begin), received));
}

void ClientLoop::on(const SliceHeader& header, const Incoming& message) {
  slice_came_ = steady_now();
  beats_since_part_ = 0;
  if (!welcome_) return;
  const bool has_payload = message.count == 2;
  const auto bytes = has_payload ? message.parts[1].bytes() : std::span<const std::byte>{};
  const auto step = [&] {
    const ReadingReceivedBytes reading;
    return assembler_.slice(header, bytes);
  }();
  on_step(step);
}

void ClientLoop::on(const FrameEnd& end, ClientTime received) {
  if (welcome_) on_step(assembler_.end(end, received));
}

void ClientLoop::on_step(FrameAssembler::Step step) {
  using Step = FrameAssembler::Step;
  const SteadyTime now = steady_now();
  if (step == Step::Ignored) return;
  if (step == Step::Advanced) {
    if (!ack_due_) ack_due_ = acked_ + kProgressAckEvery;
    return;
  }
  ack_due_ = now;
  send_acks();
  if (step != Step::Completed) return;
  ++own_counters_.frames;
  patience_ = kLeastPatience;
  auto frame = assembler_.take();
  if (frame && frames_.put(std::move(*frame)) == FrameQueue::Put::Overflowed) {
    assembler_.want_key();
  }
}

}  // namespace macula::net
