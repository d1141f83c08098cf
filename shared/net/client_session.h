// The client's half of a session as a state machine: when to say Hello, what to acknowledge, when
// to ping, what silence means, which frames are whole. It owns no socket, no thread and no clock;
// what it needs of the world is handed in. Not thread-safe; ClientLoop drives it, a simulation may.
#pragma once

#include <chrono>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "shared/net/client_endpoint.h"
#include "shared/net/frame_assembler.h"
#include "shared/net/handshake_text.h"
#include "shared/net/wakeup.h"

namespace macula::net {

class ClientSession {
 public:
  /// The world around it.
  struct Surroundings {
    std::function<SteadyTime()> steady;  ///< deadlines run on it
    std::function<ClientTime()> stamp;   ///< messages are stamped with it
    /// True when the message left; otherwise it is offered again.
    std::function<bool(const Message&)> offer;
    std::function<void(ClientEvent)> emit;
    enum class Taken { Yes, Overflowed };
    std::function<Taken(ReceivedFrame)> deliver;  ///< a whole frame
    std::function<void()> trust;                  ///< the server answered as it should
  };

  ClientSession(std::string server, const Limits& limits, Hello hello, Surroundings around);

  // What happens to the connection.
  /// A new connection is a new peer to the server: it knows nothing of the old one.
  void on_connected();
  void on_failure(const LinkFailure& failure);
  /// One message as it came: part 0, and part 1 where there is one.
  void hear(std::span<const std::byte> envelope, std::optional<std::span<const std::byte>> payload,
            ClientTime received);

  // What the user wants.
  void see(ViewState view);  ///< newest wins; dropped while not welcomed
  void say(Message settings_or_bye);
  void want_key();

  /// Offers what is due. Only on a connection that is ready.
  void talk();
  /// Tells of silence. True: it has lasted so long that the socket must be made anew, now.
  [[nodiscard]] bool is_deserted(bool is_connected);
  /// When talk() or is_deserted() has something to do next.
  SteadyTime deadline(bool is_connected) const;

  bool is_welcomed() const { return welcome_.has_value(); }
  const ClockSync& sync() const { return sync_; }
  /// Without socket_remakes.
  ClientCounters counters() const;

 private:
  void greet();
  void send_messages();
  void send_view();
  void send_acks();
  void send_ping();
  bool offer(const Message& message);
  Acks acks_now() const;
  std::chrono::milliseconds ping_every() const;
  SteadyTime quiet_since() const;

  void dispatch(Message&& message, std::optional<std::span<const std::byte>> payload,
                ClientTime received);
  void on(Welcome&& welcome);
  void on(Refusal&& refusal);
  void on(Bye&& bye);
  void on(const Pong& pong, ClientTime received);
  void on_beat();
  void on(FrameBegin&& begin, ClientTime received);
  void on(const SliceHeader& header, std::optional<std::span<const std::byte>> payload);
  void on(const FrameEnd& end, ClientTime received);
  void on_step(FrameAssembler::Step step);
  void emit_refusal(Refusal refusal);

  const std::string server_;  ///< as the user named it
  const Limits limits_;
  const Surroundings around_;
  FrameAssembler assembler_;
  ClockSync sync_;

  Hello hello_;  ///< as it is said next: with the token and the newest settings
  std::optional<Welcome> welcome_;
  std::uint64_t last_session_ = 0;
  std::optional<SteadyTime> hello_due_;
  SteadyTime hello_said_{};
  std::string last_failure_;  ///< the sentence the user has read already

  // On their way out.
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

  ClientCounters counters_;
};

}  // namespace macula::net
