#include "client/app/display_loop.h"

#include <algorithm>
#include <thread>
#include <utility>

#include "client/app/connect.h"

namespace macula::client_app {
namespace {

void sleep_for(Nanoseconds delay) {
  if (delay > Nanoseconds{0}) std::this_thread::sleep_for(delay);
}

}  // namespace

DisplayLoop::DisplayLoop(const ClientConfig& config, const LoopParts& parts)
    : config_(config),
      parts_(parts),
      rig_{eye_display(config), config.eyes, config.ipd, config.convergence},
      refreshes_(parts.clock, config.refresh_hz, config.pacing),
      warps_(rig_, warp_options(config.warp)),
      last_news_(now()) {}

display::RunEnd DisplayLoop::run() {
  while (true) {
    report_events();
    if (!parts_.screen.poll()) return display::RunEnd::WindowClosed;
    if (const auto reason = end_reason()) return *reason;
    const Refresh refresh = refreshes_.next();
    const auto predicted = predict(refresh);
    if (!predicted) return display::RunEnd::PosesEnded;
    publish(predicted->head);
    const frames::FramePtr frame = fetch(predicted->head);
    if (!frame) {
      parts_.log.note_no_picture();
      refreshes_.wait_for_display(refresh);
      continue;
    }
    submit(refresh, predicted->head.gaze, reproject(frame, predicted->stage_from_head));
    sleep_for(config_.delays.idle);
  }
}

std::optional<display::RunEnd> DisplayLoop::end_reason() const {
  using display::RunEnd;
  if (parts_.stop) return RunEnd::Interrupted;
  if (config_.frames > 0 && parts_.log.shown_frames() >= config_.frames) return RunEnd::FramesShown;
  const bool patient = config_.display == DisplayKind::Window;
  if (!patient && now() - last_news_ > config_.silence_patience) return RunEnd::ServerSilent;
  return std::nullopt;
}

std::optional<DisplayLoop::Predicted> DisplayLoop::predict(const Refresh& refresh) {
  auto head = parts_.poses.sample(refresh.pose_time);
  if (!head) return std::nullopt;
  predictor_.add(*head);
  parts_.log.note_pose(*head);
  const Nanoseconds horizon = refresh.display - refresh.begin;
  const Pose at_display = predictor_.predict(refresh.pose_time + horizon);
  // From here on times are the real clock's: pose time is another line when not in real time.
  const Nanoseconds real_from_pose = refresh.begin - refresh.pose_time;
  head->at += real_from_pose;
  head->gaze_at += real_from_pose;
  return Predicted{*head, at_display};
}

void DisplayLoop::publish(const pose::HeadSample& head) {
  net::ViewState view = rig_.view_state(head.stage_from_head, head.gaze);
  view.sequence = ++sequence_;
  view.sampled = head.at;
  view.gaze_sampled = head.gaze_at;
  view.predicted_display = head.at + refreshes_.period();
  parts_.endpoint.publish(std::move(view));
}

frames::FramePtr DisplayLoop::fetch(const pose::HeadSample& head) {
  frames::FramePtr frame =
      config_.pacing == Pacing::RealTime ? parts_.store.newest() : wait_for_news(head);
  if (frame && frame != last_frame_) last_news_ = now();
  return frame;
}

/// The server renders a view once, so the same head is published again, newly stamped, while
/// waiting: a lost frame must not end the exchange.
frames::FramePtr DisplayLoop::wait_for_news(const pose::HeadSample& head) {
  constexpr Nanoseconds kRepeat = std::chrono::milliseconds{250};  // a server stops at 500
  const auto seen = last_frame_ ? std::optional(last_frame_->id()) : std::nullopt;
  const ClientTime give_up = now() + config_.frame_patience;
  while (true) {
    if (auto frame = parts_.store.wait_newer(seen, kRepeat)) return frame;
    if (parts_.stop || now() >= give_up) return parts_.store.newest();
    pose::HeadSample again = head;
    const Nanoseconds waited = now() - again.at;
    again.at += waited;
    again.gaze_at += waited;
    publish(again);
  }
}

Showing DisplayLoop::reproject(const frames::FramePtr& frame, const Pose& stage_from_head) {
  Showing showing;
  showing.frame = frame;
  showing.reproject_begin = now();
  showing.warps = warps_.warp(*frame, stage_from_head);
  sleep_for(config_.delays.reproject);
  showing.reproject_end = now();
  return showing;
}

void DisplayLoop::submit(const Refresh& refresh, const Gaze& gaze, Showing showing) {
  refreshes_.wait_for_display(refresh);
  sleep_for(config_.delays.present);
  const std::uint64_t count = parts_.log.shown_frames();
  parts_.screen.show(warps_.pictures(), gaze);
  showing.shown = now();
  parts_.log.note_shown(showing, parts_.endpoint.clock());
  if (parts_.pictures != nullptr) parts_.pictures->show(count, warps_.pictures());
  last_frame_ = std::move(showing.frame);
}

void DisplayLoop::report_events() {
  while (const auto event = parts_.endpoint.take_event()) log_event(*event);
}

}  // namespace macula::client_app
