// The client's net thread: owns the link, greets after every connection, pings, assembles frames,
// acknowledges them at once, and notices silence. Everything that others read or hand in goes
// through mailboxes. Deadlines run on the steady clock; the given clock only stamps.
#pragma once

#include <deque>
#include <mutex>
#include <optional>
#include <vector>

#include "shared/base/mailbox.h"
#include "shared/net/client_endpoint.h"
#include "shared/net/client_link.h"
#include "shared/net/frame_assembler.h"
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

  void round();
  void sleep();
  SteadyTime next_deadline() const;
  void attend_link();
  void on_connected();
  void on_failure(const LinkFailure& failure);
  void receive_all();
  void take_outbox();
  void greet();
  void send_messages();
  void send_view();
  void send_acks();
  void send_ping();
  void notice_silence();
  void publish_state();
  /// True when the message left; otherwise it is to be offered again.
  bool offer(const Message& message);
  Acks acks_now() const;

  void on_message(const Incoming& message, ClientTime received);
  void on(Welcome&& welcome);
  void on(Refusal&& refusal);
  void on(Bye&& bye);
  void on(const Pong& pong, ClientTime received);
  void on_beat();
  void on(FrameBegin&& begin, ClientTime received);
  void on(const SliceHeader& header, const Incoming& message);
  void on(const FrameEnd& end, ClientTime received);
  void on_step(FrameAssembler::Step step);
  void dispatch(Message&& message, const Incoming& incoming, ClientTime received);
  void emit(ClientEvent event);
  void emit_refusal(Refusal refusal);
  SteadyTime quiet_since() const;
  ClientTime stamp() const { return ClientTime{clock_.now()}; }

  const ClientEndpointOptions options_;
  const base::Clock& clock_;
  Wakeup wakeup_;
  DeadlineTimer timer_;
  ClientLink link_;
  FrameAssembler assembler_;
  ClockSync sync_;

  // Of the session.
  Hello hello_;  ///< as it is said next: with the token and the newest settings
  std::optional<Welcome> welcome_;
  std::uint64_t last_session_ = 0;
  std::uint64_t connection_ = 0;
  std::optional<SteadyTime> hello_due_;
  SteadyTime hello_said_{};
  std::string last_failure_;  ///< the sentence the user has read already

  // On their way out.
  std::deque<DueView> delayed_views_;
  std::optional<ViewState> view_;
  std::deque<Message> messages_;
  bool blocked_ = false;

  // Acknowledgements, pings and silence.
  std::optional<SteadyTime> ack_due_;
  SteadyTime acked_{}, pinged_{};
  int beats_since_part_ = 0;  ///< while a frame is arriving
  std::uint64_t pings_ = 0;
  int quick_pings_ = 0;
  std::optional<SteadyTime> unanswered_since_;
  SteadyTime heard_{}, connected_{}, slice_came_{};
  bool is_stale_ = false;
  std::chrono::milliseconds patience_;  ///< silence that ends a socket; doubles until a frame comes

  ClientCounters own_counters_;
  FrameQueue frames_;
  base::Channel<ClientEvent> events_;
  mutable std::mutex mutex_;  ///< guards the three below
  Outbox outbox_;
  ClockSync published_sync_;
  ClientCounters published_counters_;
  bool stopping_ = false;
};

}  // namespace macula::net
