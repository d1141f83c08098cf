#include "shared/net/client_loop.h"

#include <algorithm>
#include <utility>

#include "shared/net/wire.h"

namespace macula::net {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr milliseconds kStaleAfter{500};
/// Silence that ends the socket: after a damaged length field no error comes, only nothing. Below a
/// second with the new handshake; doubled each time no frame follows, so that a link on which one
/// part takes longer is not cut for ever.
constexpr milliseconds kLeastPatience{700}, kMostPatience{5600};
constexpr milliseconds kPingEvery{80}, kQuickPingEvery{20}, kPingAnywayEvery{500};
constexpr int kQuickPings = 10;
/// Acks are told again without news, so that a lost one cannot hold a frame's credit.
constexpr milliseconds kAckAgainAfter{200};
constexpr milliseconds kHelloAgainAfter{1000};
constexpr milliseconds kRetryEvery{1};
constexpr std::size_t kMostDelayedViews = 4096;
constexpr std::size_t kMostMessages = 64;
constexpr std::size_t kMostEvents = 256;
constexpr int kMessagesARound = 512;
constexpr milliseconds kGoodbye{100};

SteadyTime steady_now() {
  return std::chrono::steady_clock::now();
}

}  // namespace

ClientLoop::ClientLoop(const ClientEndpointOptions& options, ClientLink::Options link,
                       const base::Clock& clock)
    : options_(options),
      clock_(clock),
      link_(std::move(link)),
      assembler_(options.limits),
      hello_(options.hello),
      patience_(kLeastPatience),
      events_(kMostEvents) {}

Result<void> ClientLoop::open() {
  return link_.open(steady_now());
}

void ClientLoop::run() {
  while (!stopping_) {
    round();
    if (!stopping_) sleep();
  }
  link_.linger(kGoodbye);  // a Bye just sent may still leave
}

void ClientLoop::round() {
  wakeup_.drain();
  attend_link();
  receive_all();
  take_outbox();
  blocked_ = false;
  if (link_.is_ready()) {
    greet();
    send_ping();
    send_acks();
    send_view();
    send_messages();
  }
  notice_silence();
  publish_state();
}

void ClientLoop::sleep() {
  // libzmq's descriptors are edge-triggered: what is here already would not wake the poll again.
  if (link_.has_input()) return;
  timer_.arm(next_deadline());
  std::vector<int> fds{wakeup_.fd(), timer_.fd()};
  if (link_.socket() != nullptr) {
    fds.push_back(link_.socket()->fd());
    fds.push_back(link_.monitor()->fd());
  }
  sleep_until_readable(fds);
}

SteadyTime ClientLoop::next_deadline() const {
  SteadyTime deadline = steady_now() + kPingEvery;
  const auto sooner = [&](std::optional<SteadyTime> due) {
    if (due) deadline = std::min(deadline, *due);
  };
  sooner(link_.deadline());
  if (!delayed_views_.empty()) sooner(delayed_views_.front().due);
  if (!link_.is_ready()) return deadline;
  sooner(hello_due_);
  sooner(ack_due_);
  if (!assembler_.is_receiving()) {
    sooner(pinged_ + (quick_pings_ < kQuickPings ? kQuickPingEvery : kPingEvery));
  }
  if (!is_stale_) sooner(heard_ + kStaleAfter);
  if (blocked_) sooner(steady_now() + kRetryEvery);
  return std::max(deadline, steady_now());
}

void ClientLoop::attend_link() {
  if (const auto failure = link_.attend(steady_now())) on_failure(*failure);
  if (link_.is_ready() && link_.connections() != connection_) on_connected();
}

/// A new connection is a new peer to the server: it knows nothing of the old one.
void ClientLoop::on_connected() {
  connection_ = link_.connections();
  welcome_.reset();
  messages_.clear();
  assembler_.start_epoch(0);
  sync_.reset();
  ack_due_.reset();
  unanswered_since_.reset();
  quick_pings_ = 0;
  connected_ = steady_now();
  hello_due_ = connected_;
}

void ClientLoop::on_failure(const LinkFailure& failure) {
  welcome_.reset();
  sync_.reset();
  if (failure.text == last_failure_) return;  // said once, while it lasts
  last_failure_ = failure.text;
  if (failure.kind == LinkFailure::Kind::Refused) {
    emit(Refused{{RefusalCode::Unspecified, failure.text}});
  } else {
    emit(Disconnected{failure.text});
  }
}

void ClientLoop::receive_all() {
  for (int i = 0; i < kMessagesARound; ++i) {
    Incoming message;
    if (!link_.receive(message)) return;
    on_message(message, stamp());
  }
}

void ClientLoop::take_outbox() {
  Outbox taken;
  {
    std::lock_guard lock(mutex_);
    std::swap(taken, outbox_);
  }
  stopping_ = taken.stop;
  if (taken.wants_key) {
    assembler_.want_key();
    ack_due_ = steady_now();
  }
  for (Message& message : taken.messages) {
    if (const auto* const settings = std::get_if<Settings>(&message)) hello_.settings = *settings;
    if (welcome_ && messages_.size() < kMostMessages) messages_.push_back(std::move(message));
  }
  std::move(taken.views.begin(), taken.views.end(), std::back_inserter(delayed_views_));
  const SteadyTime now = steady_now();
  while (!delayed_views_.empty() && delayed_views_.front().due <= now) {
    if (welcome_) view_ = std::move(delayed_views_.front().view);
    delayed_views_.pop_front();
  }
  while (delayed_views_.size() > kMostDelayedViews) delayed_views_.pop_front();
}

bool ClientLoop::offer(const Message& message) {
  const std::string envelope = encode_envelope(message);
  if (link_.send({envelope, nullptr, 0, 0}) == SendOutcome::Sent) return true;
  blocked_ = true;
  return false;
}

void ClientLoop::greet() {
  if (!hello_due_ || steady_now() < *hello_due_) return;
  if (!offer(hello_)) return;
  hello_said_ = steady_now();
  hello_due_ = hello_said_ + kHelloAgainAfter;
}

void ClientLoop::send_messages() {
  while (!messages_.empty() && offer(messages_.front())) messages_.pop_front();
}

void ClientLoop::send_view() {
  if (!welcome_) view_.reset();
  if (!view_) return;
  view_->acks = acks_now();
  if (!offer(*view_)) return;
  view_.reset();
  ack_due_.reset();
  acked_ = steady_now();
  ++own_counters_.views_sent;
}

void ClientLoop::send_acks() {
  if (!welcome_) return;
  const SteadyTime due = std::min(ack_due_.value_or(SteadyTime::max()), acked_ + kAckAgainAfter);
  if (steady_now() < due) return;
  if (!offer(acks_now())) return;
  ack_due_.reset();
  acked_ = steady_now();
}

Acks ClientLoop::acks_now() const {
  Acks acks = assembler_.acks();
  if (const auto estimate = sync_.estimate(stamp())) acks.least_rtt = estimate->min_rtt;
  return acks;
}

/// Between frames, so that neither Ping nor Pong shares the link with slices; on a link that is
/// never idle now and then anyway.
void ClientLoop::send_ping() {
  const SteadyTime now = steady_now();
  const auto every = assembler_.is_receiving()    ? kPingAnywayEvery
                     : quick_pings_ < kQuickPings ? kQuickPingEvery
                                                  : kPingEvery;
  if (now < pinged_ + every) return;
  if (!offer(Ping{pings_ + 1, stamp()})) return;
  ++pings_;
  ++quick_pings_;
  pinged_ = now;
  if (!unanswered_since_) unanswered_since_ = now;
}

SteadyTime ClientLoop::quiet_since() const {
  SteadyTime quiet = std::max(heard_, connected_);
  // A server that talks but answers no Ping does not hear us; slices on the way excuse a late Pong.
  if (unanswered_since_ && !assembler_.is_receiving()) {
    quiet = std::min(quiet, std::max(*unanswered_since_, slice_came_));
  }
  return quiet;
}

void ClientLoop::notice_silence() {
  const SteadyTime now = steady_now();
  const bool ever_heard = heard_ != SteadyTime{};
  if (ever_heard && !is_stale_ && now - heard_ >= kStaleAfter) {
    is_stale_ = true;
    emit(Stale{});
  }
  if (!link_.is_ready() || now - quiet_since() < patience_) return;
  patience_ = std::min(2 * patience_, kMostPatience);
  welcome_.reset();
  link_.remake(now);
}

void ClientLoop::publish_state() {
  own_counters_.frames_incomplete = assembler_.incomplete();
  own_counters_.socket_remakes = link_.remakes();
  std::lock_guard lock(mutex_);
  published_sync_ = sync_;
  published_counters_ = own_counters_;
}

void ClientLoop::emit(ClientEvent event) {
  // Nobody reads events: the oldest tell the story, the newest would repeat it.
  [[maybe_unused]] const bool kept = events_.put(std::move(event));
}

void ClientLoop::request_key() {
  {
    std::lock_guard lock(mutex_);
    outbox_.wants_key = true;
  }
  wakeup_.signal();
}

void ClientLoop::stop() {
  frames_.close();
  {
    std::lock_guard lock(mutex_);
    outbox_.stop = true;
  }
  wakeup_.signal();
}

void ClientLoop::publish(ViewState view) {
  {
    std::lock_guard lock(mutex_);
    // Without a delay only the newest matters.
    if (options_.delays.uplink <= Nanoseconds{0}) outbox_.views.clear();
    outbox_.views.push_back({std::move(view), steady_now() + options_.delays.uplink});
    if (outbox_.views.size() > kMostDelayedViews) outbox_.views.pop_front();
  }
  wakeup_.signal();
}

void ClientLoop::send(Message settings_or_bye) {
  {
    std::lock_guard lock(mutex_);
    if (outbox_.messages.size() < kMostMessages) {
      outbox_.messages.push_back(std::move(settings_or_bye));
    }
  }
  wakeup_.signal();
}

std::optional<ClockEstimate> ClientLoop::clock() const {
  std::lock_guard lock(mutex_);
  return published_sync_.estimate(stamp());
}

ClientCounters ClientLoop::counters() const {
  std::lock_guard lock(mutex_);
  return published_counters_;
}

}  // namespace macula::net
