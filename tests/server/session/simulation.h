// A client, a server and the network between them in virtual time: everything random comes from one
// seed, so a failing seed is a reproducible test. Views, acks and pings may be late, dropped,
// duplicated and reordered, parts of frames late, dropped and duplicated; connections break; the
// server's clock may jump; a stranger says views and acks without ever being welcomed. Both state
// machines are the real ones, net::ClientSession and SessionTable, and speak the real wire (real
// envelopes, real FrameSender); sockets, renderer and encoder are models of their timing.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "server/session/session_table.h"
#include "shared/net/client_session.h"
#include "shared/net/frame_sender.h"

namespace macula::session::test {

/// Probabilities per message, and delays in ms.
struct Faults {
  double drop = 0.0, duplicate = 0.0, network_lost = 0.0;
  double cut = 0.0;  ///< that the connection breaks, per message of the client
  double least_delay_ms = 1.0, most_delay_ms = 8.0;
};

class Simulation {
 public:
  explicit Simulation(std::uint64_t seed, const SessionRules& rules = {});

  /// Advances virtual time.
  void run_for(double ms);
  void set_faults(const Faults& faults) { faults_ = faults; }
  /// The server's memory is gone; peers stay connected and must say Hello again.
  void restart_server();
  /// The client's process is gone: a new connection of the same key, without a token.
  void restart_client();
  /// The client says nothing for a while.
  void silence_client(double ms);
  /// The server's machine slept: its clock runs on by so much at once.
  void jump_server_clock(double ms) { server_ahead_us_ += static_cast<std::int64_t>(ms * 1e3); }

  double now_ms() const { return static_cast<double>(now_us_) * 1e-3; }
  double newest_shown_ms() const { return newest_shown_ms_; }
  std::uint64_t frames_shown() const { return frames_shown_; }
  const SessionTable& table() const { return *table_; }
  std::size_t events_pending() const { return events_.size(); }
  /// The first invariant that broke, in words; empty while all hold.
  const std::string& violation() const { return violation_; }

  double uniform(double low, double high);
  bool chance(double probability) { return uniform(0.0, 1.0) < probability; }

 private:
  using SteadyClock = std::chrono::steady_clock;
  using Seen = std::pair<std::uint32_t, std::uint64_t>;  ///< epoch and frame
  SteadyClock::time_point steady() const {
    return SteadyClock::time_point{std::chrono::microseconds{now_us_}};
  }
  ServerTime now() const {
    return ServerTime{std::chrono::microseconds{now_us_ + server_ahead_us_}};
  }
  void after(double ms, std::function<void()> event);
  void require(bool holds, const std::string& what);

  // The network.
  void deliver_loosely(std::function<void()> event);
  enum class Loss { None, AsFaultsSay };
  void deliver_in_order(double& last_arrival_ms, Loss loss, std::function<void()> event);
  double delay_ms() { return uniform(faults_.least_delay_ms, faults_.most_delay_ms); }

  // The client.
  net::ClientSession::Surroundings surroundings();
  void client_step();
  /// A connection in a moment; until then there is none.
  void connect();
  void lose_connection();
  /// What the client hears of a connection that may be gone by then.
  void tell_client(const net::Message& message, net::Payload payload = nullptr);
  void on_frame(const net::ReceivedFrame& frame);
  /// Somebody whose connection was never welcomed: views and acks of a session that is not his.
  void stranger_step();

  // The server's end of the wire.
  void from_client(std::uint64_t peer, const net::Message& message);
  /// False when they name a frame that was never handed over.
  bool take_acks(std::uint64_t peer, const net::Acks& acks);
  void beat();
  void send(std::uint64_t peer, const net::Outgoing& out);

  // The server.
  void to_server(const net::ServerEvent& event);
  void carry_out(const Actions& actions);
  void release(const ReleaseFrame& action);
  void try_render();
  void finish_render(const StartFrame& start);
  void finish_encode(const StartFrame& start);
  void check_server();

  SessionRules rules_;
  std::uint64_t seed_, draws_ = 0;
  std::int64_t now_us_ = 3'600'000'000, server_ahead_us_ = 0;
  std::multimap<std::int64_t, std::function<void()>> events_;
  Faults faults_;
  std::string violation_;

  std::unique_ptr<SessionTable> table_;
  int server_generation_ = 0, free_jobs_ = 2;
  bool rendering_ = false;
  double encoder_free_ms_ = 0.0;
  std::map<FrameKey, std::uint64_t> view_of_;          ///< frames started, by the view they show
  std::map<std::uint64_t, net::FrameSender> senders_;  ///< by peer
  std::map<std::uint32_t, FrameKey> newest_released_;  ///< by epoch
  std::set<FrameKey> stopped_;

  std::unique_ptr<net::ClientSession> client_;
  std::uint64_t peer_ = 0;  ///< the newest connection's
  bool connected_ = false;
  std::uint64_t sequence_ = 0, beats_ = 0;
  std::deque<std::function<void()>> unheard_;  ///< came while the client stood still
  double next_view_ms_ = 0.0, silent_until_ms_ = -1e9;
  double downlink_arrival_ms_ = 0.0, uplink_arrival_ms_ = 0.0;
  std::optional<Seen> newest_seen_;
  std::uint64_t shown_view_ = 0, frames_shown_ = 0;
  std::set<std::uint32_t> epochs_welcomed_;
  double newest_shown_ms_ = -1e9;
};

}  // namespace macula::session::test
