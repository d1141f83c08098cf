// One client's life as a pure state machine: no threads, no sockets, no clock; time is an argument
// and actions are values. A session survives reconnections: each welcome begins a new epoch, which
// resets credit, frame ids and the view order. Frames are pulled: whoever has a free renderer asks
// start_frame().
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "server/session/actions.h"
#include "server/session/credit_window.h"
#include "server/session/governor.h"
#include "server/session/head_forecast.h"
#include "server/session/link_estimate.h"
#include "server/session/rules.h"

namespace macula::session {

/// What happened in a session since it began; only grows.
struct SessionCounters {
  std::uint64_t views = 0, stale_views = 0, invalid_views = 0;
  std::uint64_t acks_refused = 0, foreign_acks = 0;
  std::uint64_t frames_started = 0, frames_released = 0, frames_lost = 0;
  std::uint64_t frames_abandoned = 0;
  std::uint64_t keys_wanted = 0;  ///< by clients that lost a frame
  int most_in_flight = 0;         ///< over all moments after a release
  int most_in_flight_excess = 0;  ///< frames in flight above the window at a release; stays 0
};

class Session {
 public:
  Session(std::uint64_t id, std::string client_key, const SessionRules& rules)
      : id_(id),
        client_key_(std::move(client_key)),
        rules_(rules),
        credit_(rules),
        forecast_(rules) {}

  /// The client said Hello (again): from here on everything of earlier epochs is ignored.
  Actions begin_epoch(net::PeerId peer, net::Welcome welcome, ClientSetup setup, ServerTime now);
  /// Only views newer than any before count; acks are taken first, whatever the view is worth.
  Actions on_view(const net::ViewReceived& event);
  void on_settings(const net::Settings& settings);
  /// What rendering it took.
  void on_frame_rendered(const FrameKey& key, Nanoseconds render);
  /// Answers Governor::estimated_rmse().
  std::optional<double> on_error_estimated(const FrameKey& key, const SpotError& error);
  /// Encoded: it leaves as soon as there is credit.
  Actions on_frame_ready(const FrameKey& key, ServerTime now, const EncodedSize& size = {});
  /// Will never be sent (stopped, or failed to encode).
  void on_frame_abandoned(const FrameKey& key);
  Actions on_frame_sent(const net::FrameSent& event, ServerTime now);
  Actions tick(ServerTime now);

  /// A frame may start: the client is alive, has a view not yet rendered, and there is credit.
  bool may_start(ServerTime now) const;
  std::optional<StartFrame> start_frame(ServerTime now);
  bool is_expired(ServerTime now) const { return now - last_view_ > rules_.free_after; }
  /// When the client's silence will have stopped rendering.
  bool is_silent(ServerTime now) const { return now - last_view_ > rules_.stop_rendering_after; }

  std::uint64_t id() const { return id_; }
  std::uint32_t epoch() const { return welcome_.epoch; }
  net::PeerId peer() const { return peer_; }
  const std::string& client_key() const { return client_key_; }
  const net::ResumeToken& resume_token() const { return welcome_.resume_token; }
  const ClientSetup& setup() const { return *setup_; }
  const CreditWindow& credit() const { return credit_; }
  const LinkEstimate& link() const { return link_; }
  const SessionCounters& counters() const { return counters_; }

 private:
  struct Ready {
    std::uint64_t frame = 0;
    std::size_t bytes = 0;
  };
  Actions take_acks(const net::Acks& acks, ServerTime received);
  void take_key_wish(const net::Acks& acks, ServerTime received);
  /// A frame that others may lean on will never be decoded.
  void break_chain() { wants_key_ = true; }
  LinkState link_state() const;
  void follow_gazes(StartFrame& start);
  void take_view(const net::ViewState& view, ServerTime received);
  Actions release_ready(ServerTime now);
  /// Nobody watches: ready frames are dropped, the one being rendered is reported back by its
  /// stage.
  Actions abandon_unsent();
  bool is_mine(const FrameKey& key) const { return key.session == id_ && key.epoch == epoch(); }

  std::uint64_t id_;
  std::string client_key_;
  SessionRules rules_;
  net::PeerId peer_;
  net::Welcome welcome_;  ///< of the present epoch
  ServerTime welcomed_{};
  std::shared_ptr<const ClientSetup> setup_;
  CreditWindow credit_;
  HeadForecast forecast_;
  LinkEstimate link_;
  Governor governor_;
  std::array<foveation::GazeFollower, 2> followers_;  ///< by eye
  ServerTime next_start_{};                           ///< frames begin no sooner
  Nanoseconds clients_own_{0};  ///< from reading a pose to showing it, as the client says
  bool wants_key_ = false;
  std::uint64_t newest_key_ = 0;        ///< frame that was started as one
  std::optional<net::ViewState> view_;  ///< newest, not yet rendered
  ServerTime view_received_{}, last_view_{};
  std::optional<std::uint64_t> newest_sequence_;
  std::deque<Ready> ready_;  ///< encoded, waiting for credit
  SessionCounters counters_;
};

}  // namespace macula::session
