// The client's net thread: owns the link and drives the session over it. Everything that others
// read or hand in goes through mailboxes. Deadlines run on the steady clock; the given clock only
// stamps.
#pragma once

#include <deque>
#include <mutex>
#include <optional>
#include <vector>

#include "shared/base/mailbox.h"
#include "shared/net/client_endpoint.h"
#include "shared/net/client_link.h"
#include "shared/net/client_session.h"
#include "shared/net/frame_queue.h"

namespace macula::net {

class ClientLoop {
 public:
  ClientLoop(const ClientEndpointOptions& options, ClientLink::Options link,
             const base::Clock& clock);
  /// Makes the first socket; an endpoint that libzmq does not take is the user's mistake.
  Result<void> open();
  /// Until stop().
  void run();

  // Thread-safe from here on.
  void stop();
  void publish(ViewState view);
  void send(Message settings_or_bye);
  void request_key();
  FrameQueue& frames() { return frames_; }
  base::Channel<ClientEvent>& events() { return events_; }
  std::optional<ClockEstimate> clock() const;
  ClientCounters counters() const;

 private:
  struct DueView {
    ViewState view;
    SteadyTime due;
  };
  /// What other threads handed in and the net thread has not taken.
  struct Outbox {
    std::deque<DueView> views;
    std::vector<Message> messages;
    bool wants_key = false;
    bool stop = false;
  };

  ClientSession::Surroundings surroundings();
  void round();
  void sleep();
  SteadyTime next_deadline() const;
  void attend_link();
  void receive_all();
  void take_outbox();
  void publish_state();
  ClientTime stamp() const { return ClientTime{clock_.now()}; }

  const ClientEndpointOptions options_;
  const base::Clock& clock_;
  Wakeup wakeup_;
  DeadlineTimer timer_;
  ClientLink link_;
  std::uint64_t connection_ = 0;
  FrameQueue frames_;
  base::Channel<ClientEvent> events_;
  ClientSession session_;
  std::deque<DueView> delayed_views_;

  mutable std::mutex mutex_;  ///< guards the three below
  Outbox outbox_;
  ClockSync published_sync_;
  ClientCounters published_counters_;
  bool stopping_ = false;
};

}  // namespace macula::net
