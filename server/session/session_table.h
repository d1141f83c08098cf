// Every session of one server, keyed by the client's authenticated key. Pure like Session: events
// and time in, actions out. Decides who is welcome, resumes sessions by token, shares the
// renderer's time among the sessions, and frees those that fell silent. Not thread-safe; bounded
// memory.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "server/session/actions.h"
#include "server/session/hello.h"
#include "server/session/render_shares.h"
#include "server/session/rules.h"
#include "server/session/session.h"

namespace macula::session {

struct TableCounters {
  std::uint64_t welcomed = 0, resumed = 0, refused = 0, dropped = 0;
  std::uint64_t rejected_settings = 0;
};

class SessionTable {
 public:
  /// `random` gives 64 uniform bits a call; session ids, epochs and tokens come from it.
  using RandomBits = std::function<std::uint64_t()>;
  SessionTable(const SessionRules& rules, ServerOffer offer, RandomBits random);

  Actions handle(const net::ServerEvent& event, ServerTime now);
  /// Expires lost frames and silent sessions; call every few milliseconds.
  Actions tick(ServerTime now);
  /// The next frame to render, of the session that has had the least of the renderer's time;
  /// nullopt when none may start.
  std::optional<StartFrame> next_frame(ServerTime now);
  /// The frame, or what there is of it, took the renderer so long.
  void on_rendered(const FrameKey& key, Nanoseconds render) { shares_.charge(key.session, render); }
  /// Whether the frame still belongs to a living epoch; others are dropped by whoever holds them.
  bool expects(const FrameKey& key) const;
  void on_frame_rendered(const FrameKey& key, Nanoseconds render);
  /// Governor::estimated_rmse() of its session.
  std::optional<double> on_error_estimated(const FrameKey& key, const SpotError& error);
  Actions on_frame_ready(const FrameKey& key, ServerTime now, const EncodedSize& size = {});
  void on_frame_abandoned(const FrameKey& key);
  /// The server ends: a Bye to everybody, and nobody is left.
  Actions stop(const std::string& reason);

  const std::map<std::uint64_t, Session>& sessions() const { return sessions_; }
  const TableCounters& counters() const { return counters_; }
  /// Of sessions past and present.
  SessionCounters totals() const;

 private:
  Actions on_event(const net::HelloReceived& event, ServerTime now);
  Actions on_event(const net::ViewReceived& event, ServerTime now);
  Actions on_event(const net::SettingsReceived& event, ServerTime now);
  Actions on_event(const net::ByeReceived& event, ServerTime now);
  Actions on_event(const net::FrameSent& event, ServerTime now);

  Session* find_peer(net::PeerId peer);
  Session* find_key(const std::string& client_key);
  /// A session keeps its token for life, so that a lost Welcome costs nothing.
  Actions welcome(Session& session, net::PeerId peer, const net::ResumeToken& token,
                  ClientSetup setup, ServerTime now);
  void drop(std::uint64_t session, std::string reason, Actions& actions);
  Actions refuse(net::PeerId peer, net::RefusalCode code, std::string text);
  /// A peer that floods hears one refusal per interval.
  bool may_refuse_again(net::PeerId peer, ServerTime now);
  std::uint64_t fresh_id();
  net::ResumeToken fresh_token();

  struct Refused {
    net::PeerId peer;
    ServerTime at{};
  };
  SessionRules rules_;
  ServerOffer offer_;
  RandomBits random_;
  std::map<std::uint64_t, Session> sessions_;
  std::uint64_t last_served_ = 0;
  RenderShares shares_;
  std::deque<Refused> refused_;
  TableCounters counters_;
  SessionCounters past_;
};

}  // namespace macula::session
