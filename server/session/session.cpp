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
    switch (credit_.acknowledge(acks, received)) {
      case AckVerdict::AboveLastSent:
        ++counters_.acks_refused;
        break;
      case AckVerdict::Taken:
        forecast_.on_received(acks.received, received);
        break;
      case AckVerdict::Repeated:
        break;
    }
    return {};
  }
  ++counters_.foreign_acks;
  if (received - welcomed_ < rules_.welcome_interval) return {};
  welcomed_ = received;
  return {SendWelcome{peer_, welcome_}};
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
  view_received_ = received;
  last_view_ = std::max(last_view_, received);
}

void Session::on_settings(const net::Settings& settings) {
  ClientSetup changed = *setup_;
  changed.settings = settings;
  setup_ = std::make_shared<const ClientSetup>(std::move(changed));
}

bool Session::may_start(ServerTime now) const {
  return view_ && !is_silent(now) && credit_.may_start(now);
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
  start.view.stage_from_head = forecast_.stage_from_head(start.view);
  forecast_.on_started(start.key.frame, view_received_);
  return start;
}

Actions Session::on_frame_ready(const FrameKey& key, ServerTime now) {
  if (!is_mine(key) || !credit_.is_unsent(key.frame)) return {};
  ready_.push_back(key.frame);
  return release_ready(now);
}

void Session::on_frame_abandoned(const FrameKey& key) {
  if (!is_mine(key) || !credit_.is_unsent(key.frame)) return;
  credit_.abandon(key.frame);
  std::erase(ready_, key.frame);
  ++counters_.frames_abandoned;
}

Actions Session::release_ready(ServerTime now) {
  Actions actions;
  while (!ready_.empty() && credit_.may_send(now)) {
    const int window = credit_.window(now);
    const std::uint64_t frame = ready_.front();
    ready_.pop_front();
    credit_.hand_over(frame, now);
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
    return release_ready(now);
  }
  credit_.on_sent(event.frame, event.end);
  return {};
}

Actions Session::abandon_unsent() {
  if (credit_.unsent() == 0) return {};
  counters_.frames_abandoned += ready_.size();
  for (const std::uint64_t frame : ready_) credit_.abandon(frame);
  ready_.clear();
  return {AbandonFrames{id_, epoch()}};
}

Actions Session::tick(ServerTime now) {
  counters_.frames_lost += static_cast<std::uint64_t>(credit_.expire(now));
  return is_silent(now) ? abandon_unsent() : release_ready(now);
}

}  // namespace macula::session
