#include "server/session/session.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "shared/math/fov.h"
#include "shared/math/pose.h"

namespace macula::session {
namespace {

// The network checks every message; a renderer fed a NaN would be our fault, so look once more.
bool is_renderable(const net::ViewState& view, std::size_t eyes) {
  return view.eyes.size() == eyes && math::is_valid(view.stage_from_head) &&
         std::all_of(view.eyes.begin(), view.eyes.end(), [](const net::EyeState& eye) {
           return math::is_valid(eye.head_from_eye) && math::is_valid(eye.fov);
         });
}

}  // namespace

Actions Session::begin_epoch(net::PeerId peer, net::Welcome welcome, ClientSetup setup,
                             ServerTime now) {
  Actions actions;
  if (epoch() != 0) {
    counters_.frames_abandoned += static_cast<std::uint64_t>(credit_.unsent());
    actions.push_back(AbandonFrames{id_, epoch()});
  }
  peer_ = peer;
  welcome_ = std::move(welcome);
  welcomed_ = now;
  setup_ = std::make_shared<const ClientSetup>(std::move(setup));
  credit_ = CreditWindow(rules_);
  forecast_ = HeadForecast(rules_);
  link_ = {};
  governor_ = Governor(rules_.goals);
  foveation::GazeFollowerOptions gaze = rules_.gaze;
  if (setup_->settings.color_codec == "h264") gaze.rest = rules_.grid_rest;
  followers_.fill(foveation::GazeFollower(gaze));
  next_start_ = {};
  wants_key_ = false;
  newest_key_ = 0;
  view_.reset();
  newest_sequence_.reset();
  ready_.clear();
  last_view_ = now;
  actions.push_back(SendWelcome{peer_, welcome_});
  return actions;
}

Actions Session::on_view(const net::ViewReceived& event) {
  Actions actions = take_acks(event.acks, event.received);
  if (event.view) take_view(*event.view, event.received);
  const Actions released = release_ready(event.received);
  actions.insert(actions.end(), released.begin(), released.end());
  return actions;
}

Actions Session::take_acks(const net::Acks& acks, ServerTime received) {
  if (acks.epoch == epoch()) {
    const AckVerdict verdict = credit_.acknowledge(acks, received);
    if (verdict == AckVerdict::AboveLastSent) {
      ++counters_.acks_refused;
      return {};
    }
    if (verdict == AckVerdict::Taken) forecast_.on_received(acks.received, received);
    link_.on_acks(acks, received);
    take_key_wish(acks, received);
    return {};
  }
  ++counters_.foreign_acks;
  if (received - welcomed_ < rules_.welcome_interval) return {};
  welcomed_ = received;
  return {SendWelcome{peer_, welcome_}};
}

/// A client repeats its wish until a key frame is there: one on its way is answer enough.
void Session::take_key_wish(const net::Acks& acks, ServerTime received) {
  const bool is_on_its_way = newest_key_ > acks.received;
  if (!acks.need_key || wants_key_ || is_on_its_way) return;
  wants_key_ = true;
  ++counters_.keys_wanted;
  governor_.on_key_wanted(received);
}

void Session::take_view(const net::ViewState& view, ServerTime received) {
  if (!is_renderable(view, setup_->eyes.size())) {
    ++counters_.invalid_views;
    return;
  }
  if (newest_sequence_ && view.sequence <= *newest_sequence_) {
    ++counters_.stale_views;
    return;
  }
  ++counters_.views;
  newest_sequence_ = view.sequence;
  view_ = view;
  forecast_.add(view);
  for (std::size_t eye = 0; eye < view.eyes.size(); ++eye) {
    followers_[eye].add(view.eyes[eye].gaze, view.gaze_sampled);
  }
  clients_own_ = std::clamp<Nanoseconds>(view.predicted_display - view.sampled, Nanoseconds{0},
                                         std::chrono::milliseconds{50});
  view_received_ = received;
  last_view_ = std::max(last_view_, received);
}

void Session::on_settings(const net::Settings& settings) {
  ClientSetup changed = *setup_;
  changed.settings = settings;
  setup_ = std::make_shared<const ClientSetup>(std::move(changed));
}

bool Session::may_start(ServerTime now) const {
  return view_ && !is_silent(now) && credit_.may_start(now) && now >= next_start_;
}

LinkState Session::link_state() const {
  return {link_.bytes_per_s(), link_.least_rtt(), clients_own_};
}

void Session::follow_gazes(StartFrame& start) {
  const Nanoseconds read_before = std::clamp<Nanoseconds>(
      start.view.sampled - start.view.gaze_sampled, Nanoseconds{0}, std::chrono::seconds{1});
  const Nanoseconds age = forecast_.age(start.view) + read_before;
  for (std::size_t eye = 0; eye < start.view.eyes.size(); ++eye) {
    start.gazes.push_back(followers_[eye].follow(age));
  }
}

std::optional<StartFrame> Session::start_frame(ServerTime now) {
  if (!may_start(now)) return std::nullopt;
  ++counters_.frames_started;
  StartFrame start{{id_, epoch(), credit_.start()},
                   peer_,
                   *std::exchange(view_, std::nullopt),
                   view_received_,
                   setup_};
  start.horizon = forecast_.horizon(start.view);
  start.guard_band = forecast_.guard_band(start.view, now);
  if (setup_->takes_hidden_layer) start.view_cell_m = forecast_.view_cell_m(start.view, now);
  follow_gazes(start);
  start.view.stage_from_head = forecast_.stage_from_head(start.view);
  start.quality = governor_.plan(link_state(), now);
  next_start_ = now + start.quality.bytes.least_interval;
  start.is_key_wanted = std::exchange(wants_key_, false);
  if (start.is_key_wanted) newest_key_ = start.key.frame;
  forecast_.on_started(start.key.frame, view_received_);
  return start;
}

void Session::on_frame_rendered(const FrameKey& key, Nanoseconds render) {
  if (is_mine(key)) governor_.on_rendered(render);
}

std::optional<double> Session::on_error_estimated(const FrameKey& key, const SpotError& error) {
  if (is_mine(key)) governor_.on_error_estimated(error);
  return governor_.estimated_rmse();
}

Actions Session::on_frame_ready(const FrameKey& key, ServerTime now, const EncodedSize& size) {
  if (!is_mine(key) || !credit_.is_unsent(key.frame)) return {};
  if (size.cells > 0) governor_.on_encoded(size);
  ready_.push_back({key.frame, size.bytes()});
  return release_ready(now);
}

void Session::on_frame_abandoned(const FrameKey& key) {
  if (!is_mine(key) || !credit_.is_unsent(key.frame)) return;
  credit_.abandon(key.frame);
  std::erase_if(ready_, [&](const Ready& ready) { return ready.frame == key.frame; });
  break_chain();
  ++counters_.frames_abandoned;
}

Actions Session::release_ready(ServerTime now) {
  Actions actions;
  while (!ready_.empty() && credit_.may_send(now)) {
    const int window = credit_.window(now);
    const auto [frame, bytes] = ready_.front();
    ready_.pop_front();
    credit_.hand_over(frame, now);
    link_.on_handed_over(frame, bytes, now);
    actions.push_back(ReleaseFrame{{id_, epoch(), frame}, peer_});
    ++counters_.frames_released;
    counters_.most_in_flight = std::max(counters_.most_in_flight, credit_.in_flight());
    counters_.most_in_flight_excess =
        std::max(counters_.most_in_flight_excess, credit_.in_flight() - window);
  }
  return actions;
}

Actions Session::on_frame_sent(const net::FrameSent& event, ServerTime now) {
  if (event.epoch != epoch()) return {};
  if (event.lost) {
    if (credit_.on_lost(event.frame)) ++counters_.frames_lost;
    break_chain();
    return release_ready(now);
  }
  credit_.on_sent(event.frame, event.end);
  return {};
}

Actions Session::abandon_unsent() {
  if (credit_.unsent() == 0) return {};
  counters_.frames_abandoned += ready_.size();
  for (const Ready& ready : ready_) credit_.abandon(ready.frame);
  ready_.clear();
  break_chain();
  return {AbandonFrames{id_, epoch()}};
}

Actions Session::tick(ServerTime now) {
  counters_.frames_lost += static_cast<std::uint64_t>(credit_.expire(now));
  return is_silent(now) ? abandon_unsent() : release_ready(now);
}

}  // namespace macula::session
