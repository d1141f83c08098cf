#include "client/app/display_loop.h"

#include <algorithm>
#include <thread>
#include <utility>

#include "client/app/connect.h"
#include "client/app/settle.h"

namespace macula::client_app {
namespace {

void sleep_for(Nanoseconds delay) {
  if (delay > Nanoseconds{0}) std::this_thread::sleep_for(delay);
}

}  // namespace

DisplayLoop::DisplayLoop(const ClientConfig& config, const LoopParts& parts)
    : config_(config),
      parts_(parts),
      warps_(
          warp_options(config.warp),
          config.display == DisplayKind::OpenXr ? WarpStage::Depth::Keep : WarpStage::Depth::Leave,
          config.warp_on == ClientConfig::WarpOn::Gl ? WarpStage::On::Gl : WarpStage::On::Cpu),
      late_start_(units::from_s(1.0 / config.refresh_hz)),
      last_news_(now()) {}

display::RunEnd DisplayLoop::run() {
  while (true) {
    report_events();
    if (const auto reason = parts_.screen.poll()) return *reason;
    if (const auto reason = end_reason()) return *reason;
    auto refresh = parts_.screen.next_refresh();
    if (!refresh) continue;
    begin_late(*refresh);
    const auto predicted = predict(*refresh);
    if (!predicted) return display::RunEnd::PosesEnded;
    const Nanoseconds until_display = refresh->display - refresh->begin;
    publish(predicted->head, until_display);
    const frames::FramePtr frame = fetch(predicted->head, until_display);
    if (!frame) {
      parts_.log.note_no_picture();
      parts_.screen.skip(*refresh);
      continue;
    }
    Showing showing = reproject(frame, predicted->stage_from_head);
    compare(frame);
    submit(*refresh, *predicted, std::move(showing));
    sleep_for(config_.delays.idle);
  }
}

std::optional<display::RunEnd> DisplayLoop::end_reason() const {
  using display::RunEnd;
  if (parts_.stop) return RunEnd::Interrupted;
  if (config_.frames > 0 && parts_.log.shown_frames() >= config_.frames) return RunEnd::FramesShown;
  const bool patient = config_.display != DisplayKind::Headless;
  if (!patient && now() - last_news_ > config_.silence_patience) return RunEnd::ServerSilent;
  return std::nullopt;
}

/// Meanwhile the server hears of the head, so that a frame begun now begins from a new one. A
/// headset's runtime says itself when to begin.
void DisplayLoop::begin_late(Refresh& refresh) {
  if (config_.pacing != Pacing::RealTime || config_.display == DisplayKind::OpenXr) return;
  constexpr Nanoseconds kViewEvery = std::chrono::milliseconds{4};
  const ClientTime start = refresh.display - late_start_.lead();
  while (start - now() > kViewEvery / 2) {
    const auto head = parts_.poses.sample(now());
    if (!head) return;
    publish(*head, refresh.display - head->at);
    sleep_for(std::min(kViewEvery, start - now()));
  }
  const Nanoseconds passed = now() - refresh.begin;
  refresh.begin += passed;
  refresh.pose_time += passed;
}

std::optional<DisplayLoop::Predicted> DisplayLoop::predict(const Refresh& refresh) {
  auto head = parts_.poses.sample(refresh.pose_time);
  if (!head) return std::nullopt;
  predictor_.add(*head);
  doubt_.add(*head);
  parts_.log.note_pose(*head);
  if (parts_.recorder != nullptr) parts_.recorder->add(*head);
  const Nanoseconds horizon = refresh.display - refresh.begin;
  const ClientTime display = refresh.pose_time + horizon;
  const auto forecast = parts_.poses.forecast(display);
  Pose at_display = forecast ? *forecast : predictor_.predict(display);
  hold(*head, at_display);
  // From here on times are the real clock's: pose time is another line when not in real time.
  const Nanoseconds real_from_pose = refresh.begin - refresh.pose_time;
  head->at += real_from_pose;
  head->gaze_at += real_from_pose;
  return Predicted{*head, at_display, display, real_from_pose};
}

void DisplayLoop::hold(pose::HeadSample& head, Pose& at_display) {
  if (parts_.screen.compared_ways()) {
    head.stage_from_head = at_display = comparison_.hold(at_display);
  } else if (comparison_.holds()) {
    comparison_.end();
  }
}

void DisplayLoop::compare(const frames::FramePtr& frame) {
  const auto ways = parts_.screen.compared_ways();
  const bool held = ways && comparison_.holds();
  if (held) comparison_.update(frame, parts_.screen.rig(), *ways);
  parts_.screen.compare(held ? &comparison_ : nullptr);
}

void DisplayLoop::publish(const pose::HeadSample& head, Nanoseconds until_display) {
  net::ViewState view = parts_.screen.rig().view_state(head.stage_from_head, head.gaze);
  view.sequence = ++sequence_;
  view.sampled = head.at;
  view.gaze_sampled = head.gaze_at;
  view.predicted_display = head.at + until_display;
  parts_.endpoint.publish(std::move(view));
}

frames::FramePtr DisplayLoop::fetch(const pose::HeadSample& head, Nanoseconds until_display) {
  frames::FramePtr frame = config_.pacing == Pacing::RealTime ? parts_.store.newest()
                                                              : wait_for_news(head, until_display);
  if (frame && frame != last_frame_) last_news_ = now();
  return frame;
}

/// The server renders a view once, so the same head is published again, newly stamped, while
/// waiting: a lost frame must not end the exchange.
frames::FramePtr DisplayLoop::wait_for_news(const pose::HeadSample& head,
                                            Nanoseconds until_display) {
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
    publish(again, until_display);
  }
}

Showing DisplayLoop::reproject(const frames::FramePtr& frame, const Pose& stage_from_head) {
  Showing showing;
  showing.frame = frame;
  showing.reproject_begin = now();
  const bool real_time = config_.pacing == Pacing::RealTime;
  const Nanoseconds age = real_time ? now() - frame->last_byte : Nanoseconds{0};
  showing.warps = warps_.warp(*frame, stage_from_head, parts_.screen.rig(), settled_share(age));
  warps_.mark_age(age);
  sleep_for(config_.delays.reproject);
  showing.reproject_end = now();
  return showing;
}

void DisplayLoop::submit(const Refresh& refresh, const Predicted& predicted, Showing showing) {
  const std::uint64_t count = parts_.log.shown_frames();
  const ClientTime lit = parts_.screen.show(refresh, warps_.eyes(), predicted.head.gaze);
  sleep_for(config_.delays.present);
  showing.shown = lit + config_.delays.present;
  const bool real_time = config_.pacing == Pacing::RealTime;
  judge(showing, predicted,
        real_time ? showing.shown - predicted.real_from_pose : predicted.display);
  late_start_.note(showing.reproject_end - refresh.begin, lit - refresh.display);
  parts_.log.note_shown(showing, parts_.endpoint.clock());
  parts_.screen.note(showing, parts_.log, parts_.endpoint);
  if (parts_.pictures != nullptr) parts_.pictures->show(count, pictures());
  last_frame_ = std::move(showing.frame);
}

/// How far off the frame is shown; once a frame and after its light is out, for it costs a few
/// milliseconds. The pose is held to where the head was when it was `seen`: what the display was
/// late by is part of what the pose is off.
void DisplayLoop::judge(Showing& showing, const Predicted& predicted, ClientTime seen) {
  doubt_.foretold(seen, predicted.stage_from_head);
  if (showing.frame == last_frame_) return;
  showing.bound = warps_.bound(*showing.frame, predicted.stage_from_head, parts_.screen.rig(),
                               {doubt_.position_m(), doubt_.turn()});
}

void DisplayLoop::report_events() {
  while (const auto event = parts_.endpoint.take_event()) log_event(*event);
}

}  // namespace macula::client_app
