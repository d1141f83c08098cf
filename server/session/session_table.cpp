#include "server/session/session_table.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "shared/base/text.h"

namespace macula::session {
namespace {

constexpr std::size_t kMostRefused = 64;

void append(Actions& actions, Actions more) {
  actions.insert(actions.end(), std::make_move_iterator(more.begin()),
                 std::make_move_iterator(more.end()));
}

void add(SessionCounters& sum, const SessionCounters& more) {
  sum.views += more.views;
  sum.stale_views += more.stale_views;
  sum.invalid_views += more.invalid_views;
  sum.acks_refused += more.acks_refused;
  sum.foreign_acks += more.foreign_acks;
  sum.frames_started += more.frames_started;
  sum.frames_released += more.frames_released;
  sum.frames_lost += more.frames_lost;
  sum.frames_abandoned += more.frames_abandoned;
  sum.keys_wanted += more.keys_wanted;
  sum.most_in_flight = std::max(sum.most_in_flight, more.most_in_flight);
  sum.most_in_flight_excess = std::max(sum.most_in_flight_excess, more.most_in_flight_excess);
}

std::string version_text(std::uint32_t theirs) {
  return base::concat("this server speaks protocol version ", net::kProtocolVersion,
                      ", the client speaks version ", theirs, ": install the same release on both");
}

}  // namespace

SessionTable::SessionTable(const SessionRules& rules, ServerOffer offer, RandomBits random)
    : rules_(rules), offer_(std::move(offer)), random_(std::move(random)) {}

Actions SessionTable::handle(const net::ServerEvent& event, ServerTime now) {
  return std::visit([&](const auto& specific) { return on_event(specific, now); }, event);
}

Session* SessionTable::find_peer(net::PeerId peer) {
  for (auto& [id, session] : sessions_)
    if (session.peer() == peer) return &session;
  return nullptr;
}

Session* SessionTable::find_key(const std::string& client_key) {
  for (auto& [id, session] : sessions_)
    if (session.client_key() == client_key) return &session;
  return nullptr;
}

std::uint64_t SessionTable::fresh_id() {
  for (;;)
    if (const std::uint64_t id = random_(); id != 0 && !sessions_.contains(id)) return id;
}

net::ResumeToken SessionTable::fresh_token() {
  net::ResumeToken token;
  const std::uint64_t words[2] = {random_(), random_()};
  static_assert(sizeof(words) == sizeof(token));
  std::memcpy(token.data(), words, sizeof(words));
  return token;
}

Actions SessionTable::refuse(net::PeerId peer, net::RefusalCode code, std::string text) {
  ++counters_.refused;
  return {SendRefusal{peer, {code, std::move(text)}}};
}

bool SessionTable::may_refuse_again(net::PeerId peer, ServerTime now) {
  const auto known = std::find_if(refused_.begin(), refused_.end(),
                                  [&](const Refused& r) { return r.peer == peer; });
  if (known != refused_.end()) {
    if (now - known->at < rules_.refusal_interval) return false;
    refused_.erase(known);
  }
  refused_.push_back({peer, now});
  if (refused_.size() > kMostRefused) refused_.pop_front();
  return true;
}

Actions SessionTable::on_event(const net::HelloReceived& event, ServerTime now) {
  if (event.hello.protocol_version != net::kProtocolVersion)
    return refuse(event.peer, net::RefusalCode::VersionMismatch,
                  version_text(event.hello.protocol_version));
  auto setup = check_hello(event.hello, offer_);
  if (!setup) return refuse(event.peer, net::RefusalCode::BadRequest, setup.error().message());

  Actions actions;
  if (Session* known = find_key(event.client_key_z85)) {
    if (known->peer() != event.peer)
      actions.push_back(SendBye{known->peer(), {"another connection uses this client's key", 0}});
    if (event.hello.resume_token == known->resume_token()) {
      ++counters_.resumed;
      const net::ResumeToken token = known->resume_token();
      append(actions, welcome(*known, event.peer, token, std::move(*setup), now));
      return actions;
    }
    drop(known->id(), "replaced by a new connection of the same client", actions);
  }
  if (sessions_.size() >= rules_.most_sessions) {
    append(actions, refuse(event.peer, net::RefusalCode::ServerFull,
                           base::concat("this server serves at most ", rules_.most_sessions,
                                        " clients at once: try again later")));
    return actions;
  }
  const std::uint64_t id = fresh_id();
  Session& session = sessions_.try_emplace(id, id, event.client_key_z85, rules_).first->second;
  append(actions, welcome(session, event.peer, fresh_token(), std::move(*setup), now));
  return actions;
}

Actions SessionTable::welcome(Session& session, net::PeerId peer, const net::ResumeToken& token,
                              ClientSetup setup, ServerTime now) {
  std::uint32_t epoch = 0;
  while (epoch == 0 || epoch == session.epoch()) epoch = static_cast<std::uint32_t>(random_());
  net::Welcome welcome;
  welcome.session = session.id();
  welcome.epoch = epoch;
  welcome.resume_token = token;
  welcome.color_codec = setup.settings.color_codec;
  welcome.kernel = offer_.kernel;
  welcome.frame_window = static_cast<std::uint32_t>(rules_.least_window);
  welcome.max_part_bytes = offer_.max_part_bytes;
  welcome.scene = offer_.scene;
  ++counters_.welcomed;
  return session.begin_epoch(peer, std::move(welcome), std::move(setup), now);
}

Actions SessionTable::on_event(const net::ViewReceived& event, ServerTime now) {
  if (Session* session = find_peer(event.peer)) return session->on_view(event);
  if (!may_refuse_again(event.peer, now)) return {};
  return refuse(event.peer, net::RefusalCode::UnknownSession,
                "this server does not know the session: say Hello again");
}

Actions SessionTable::on_event(const net::SettingsReceived& event, ServerTime) {
  Session* session = find_peer(event.peer);
  if (session == nullptr) return {};
  net::Settings settings = event.settings;
  if (!check_settings(settings)) {
    ++counters_.rejected_settings;
    return {};
  }
  if (settings.color_codec.empty()) settings.color_codec = session->setup().settings.color_codec;
  session->on_settings(settings);
  return {};
}

Actions SessionTable::on_event(const net::ByeReceived& event, ServerTime) {
  Actions actions;
  if (const Session* session = find_peer(event.peer))
    drop(session->id(), "the client said goodbye: " + event.bye.reason, actions);
  return actions;
}

Actions SessionTable::on_event(const net::FrameSent& event, ServerTime now) {
  Session* session = find_peer(event.peer);
  return session ? session->on_frame_sent(event, now) : Actions{};
}

void SessionTable::drop(std::uint64_t id, std::string reason, Actions& actions) {
  const auto found = sessions_.find(id);
  if (found == sessions_.end()) return;
  actions.emplace_back(AbandonFrames{id, found->second.epoch()});
  actions.emplace_back(DropSession{id, std::move(reason)});
  add(past_, found->second.counters());
  sessions_.erase(found);
  shares_.forget(id);
  ++counters_.dropped;
}

Actions SessionTable::tick(ServerTime now) {
  Actions actions;
  std::vector<std::uint64_t> expired;
  for (auto& [id, session] : sessions_) {
    if (session.is_expired(now))
      expired.push_back(id);
    else
      append(actions, session.tick(now));
  }
  for (const std::uint64_t id : expired) drop(id, "no view for 3 s", actions);
  return actions;
}

std::optional<StartFrame> SessionTable::next_frame(ServerTime now) {
  Session* next = nullptr;
  // Among equals the one after the last served.
  const auto consider = [&](auto begin, auto end) {
    for (auto at = begin; at != end; ++at) {
      Session& session = at->second;
      if (!session.may_start(now)) continue;
      if (!next || shares_.start_tag(session.id()) < shares_.start_tag(next->id())) next = &session;
    }
  };
  const auto after_last = sessions_.upper_bound(last_served_);
  consider(after_last, sessions_.end());
  consider(sessions_.begin(), after_last);
  if (!next) return std::nullopt;
  last_served_ = next->id();
  shares_.begin(next->id());
  return next->start_frame(now);
}

bool SessionTable::expects(const FrameKey& key) const {
  const auto found = sessions_.find(key.session);
  return found != sessions_.end() && found->second.epoch() == key.epoch &&
         found->second.credit().is_unsent(key.frame);
}

void SessionTable::on_frame_rendered(const FrameKey& key, Nanoseconds render) {
  if (const auto found = sessions_.find(key.session); found != sessions_.end())
    found->second.on_frame_rendered(key, render);
}

std::optional<double> SessionTable::on_error_estimated(const FrameKey& key,
                                                       const SpotError& error) {
  const auto found = sessions_.find(key.session);
  return found == sessions_.end() ? std::nullopt : found->second.on_error_estimated(key, error);
}

Actions SessionTable::on_frame_ready(const FrameKey& key, ServerTime now, const EncodedSize& size) {
  const auto found = sessions_.find(key.session);
  return found == sessions_.end() ? Actions{} : found->second.on_frame_ready(key, now, size);
}

void SessionTable::on_frame_abandoned(const FrameKey& key) {
  if (const auto found = sessions_.find(key.session); found != sessions_.end())
    found->second.on_frame_abandoned(key);
}

Actions SessionTable::stop(const std::string& reason) {
  constexpr std::uint32_t kRetryAfterMs = 500;
  Actions actions;
  for (const auto& [id, session] : sessions_)
    actions.push_back(SendBye{session.peer(), {reason, kRetryAfterMs}});
  while (!sessions_.empty()) drop(sessions_.begin()->first, reason, actions);
  return actions;
}

SessionCounters SessionTable::totals() const {
  SessionCounters sum = past_;
  for (const auto& [id, session] : sessions_) add(sum, session.counters());
  return sum;
}

}  // namespace macula::session
