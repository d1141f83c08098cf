#include "shared/net/client_loop.h"

#include <algorithm>
#include <utility>

#include "shared/net/client_timing.h"
#include "shared/net/wire.h"

namespace macula::net {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::size_t kMostDelayedViews = 4096;
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
      events_(kMostEvents),
      session_(options.connect, options.limits, options.hello, surroundings()) {}

ClientSession::Surroundings ClientLoop::surroundings() {
  using Taken = ClientSession::Surroundings::Taken;
  return {
      .steady = steady_now,
      .stamp = [this] { return stamp(); },
      .offer =
          [this](const Message& message) {
            const std::string envelope = encode_envelope(message);
            return link_.send({envelope, nullptr, 0, 0}) == SendOutcome::Sent;
          },
      .emit =
          [this](ClientEvent event) {
            // Nobody reads events: the oldest tell the story, the newest would repeat it.
            [[maybe_unused]] const bool kept = events_.put(std::move(event));
          },
      .deliver =
          [this](ReceivedFrame frame) {
            const bool kept = frames_.put(std::move(frame)) == FrameQueue::Put::Kept;
            return kept ? Taken::Yes : Taken::Overflowed;
          },
      .trust = [this] { link_.trust(); },
  };
}

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
  if (link_.is_ready()) session_.talk();
  if (session_.is_deserted(link_.is_ready())) link_.remake(steady_now());
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
  SteadyTime deadline = session_.deadline(link_.is_ready());
  if (const auto due = link_.deadline()) deadline = std::min(deadline, *due);
  if (!delayed_views_.empty()) deadline = std::min(deadline, delayed_views_.front().due);
  return std::max(deadline, steady_now());
}

void ClientLoop::attend_link() {
  if (const auto failure = link_.attend(steady_now())) session_.on_failure(*failure);
  if (!link_.is_ready() || link_.connections() == connection_) return;
  connection_ = link_.connections();
  session_.on_connected();
}

void ClientLoop::receive_all() {
  for (int i = 0; i < kMessagesARound; ++i) {
    Incoming message;
    if (!link_.receive(message)) return;
    const bool has_payload = message.count == 2;
    session_.hear(message.parts[0].bytes(),
                  has_payload ? std::optional(message.parts[1].bytes()) : std::nullopt, stamp());
  }
}

void ClientLoop::take_outbox() {
  Outbox taken;
  {
    std::lock_guard lock(mutex_);
    std::swap(taken, outbox_);
  }
  stopping_ = taken.stop;
  if (taken.wants_key) session_.want_key();
  for (Message& message : taken.messages) session_.say(std::move(message));
  std::move(taken.views.begin(), taken.views.end(), std::back_inserter(delayed_views_));
  const SteadyTime now = steady_now();
  while (!delayed_views_.empty() && delayed_views_.front().due <= now) {
    session_.see(std::move(delayed_views_.front().view));
    delayed_views_.pop_front();
  }
  while (delayed_views_.size() > kMostDelayedViews) delayed_views_.pop_front();
}

void ClientLoop::publish_state() {
  ClientCounters counters = session_.counters();
  counters.socket_remakes = link_.remakes();
  std::lock_guard lock(mutex_);
  published_sync_ = session_.sync();
  published_counters_ = counters;
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
