#include "client/app/headset_screen.h"

#include <stdlib.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>
#include <vector>

#include "client/display/openxr/headset.h"
#include "client/display/window/hidden_context.h"
#include "shared/base/log.h"
#include "shared/base/text.h"

namespace macula::client_app {
namespace {

using namespace std::chrono_literals;

/// How long to sleep between two looks at a runtime that wants no frames.
constexpr auto kIdlePause = 10ms;

/// The head as the runtime tracks it. A moment without tracking keeps the last pose.
class HeadsetPoses final : public pose::PoseSource {
 public:
  explicit HeadsetPoses(display::Headset& headset) : headset_(headset) {}

  std::optional<pose::HeadSample> sample(ClientTime at) override {
    if (const auto head = headset_.stage_from_head(at)) last_ = *head;
    const display::HeadsetGaze gaze = headset_.gaze(at);
    return pose::HeadSample{at, last_, gaze.gaze, gaze.at};
  }
  std::optional<Pose> forecast(ClientTime at) override { return headset_.stage_from_head(at); }

 private:
  display::Headset& headset_;
  Pose last_;
};

class HeadsetScreen final : public Screen {
 public:
  HeadsetScreen(std::unique_ptr<display::HiddenContext> context,
                std::unique_ptr<display::Headset> headset, const base::Clock& clock,
                Meters convergence)
      : context_(std::move(context)), headset_(std::move(headset)), clock_(clock) {
    rig_.convergence = convergence;
    const auto& [width_px, height_px] = headset_->eye_px();
    for (const display::HeadsetEye& eye : headset_->first_eyes())
      rig_.eyes.push_back({Pose{}, {eye.fov, width_px, height_px}});
  }

  std::optional<display::RunEnd> poll() override;
  std::optional<Refresh> next_refresh() override;
  const EyeRig& rig() const override { return rig_; }
  ClientTime show(const Refresh& refresh, const WarpedEyes& eyes, const Gaze&) override;
  void skip(const Refresh&) override { headset_->end_frame(eyes_, {}); }
  double refresh_hz() const override { return headset_->refresh_hz(); }
  std::uint64_t missed_refreshes() const override { return missed_; }
  std::unique_ptr<pose::PoseSource> viewer() override {
    return std::make_unique<HeadsetPoses>(*headset_);
  }

 private:
  /// Eyes and head at the frame's display time; false where the runtime does not know them.
  bool locate(const display::HeadsetFrame& frame);
  void count_missed(const display::HeadsetFrame& frame);

  const std::unique_ptr<display::HiddenContext> context_;  // outlives the headset
  const std::unique_ptr<display::Headset> headset_;
  const base::Clock& clock_;
  EyeRig rig_;
  display::HeadsetEyes eyes_;
  display::HeadsetState state_ = display::HeadsetState::Running;
  std::uint64_t index_ = 0, missed_ = 0;
  std::optional<ClientTime> last_display_;
};

std::optional<display::RunEnd> HeadsetScreen::poll() {
  state_ = headset_->poll();
  switch (state_) {
    case display::HeadsetState::Closed:
      return display::RunEnd::HeadsetClosed;
    case display::HeadsetState::Lost:
      return display::RunEnd::HeadsetLost;
    case display::HeadsetState::Idle:
      last_display_.reset();  // a pause is nobody's lateness
      break;
    case display::HeadsetState::Running:
      break;
  }
  return std::nullopt;
}

bool HeadsetScreen::locate(const display::HeadsetFrame& frame) {
  const auto eyes = headset_->eyes(frame.display);
  const auto head = headset_->stage_from_head(frame.display);
  if (!eyes || !head) return false;
  eyes_ = *eyes;
  const Pose head_from_stage = math::inverse(*head);
  for (std::size_t i = 0; i < rig_.eyes.size(); ++i) {
    rig_.eyes[i].head_from_eye = head_from_stage * eyes_[i].stage_from_eye;
    rig_.eyes[i].display.fov = eyes_[i].fov;
  }
  return true;
}

void HeadsetScreen::count_missed(const display::HeadsetFrame& frame) {
  if (last_display_ && frame.period > Nanoseconds{0}) {
    const auto periods = (frame.display - *last_display_ + frame.period / 2) / frame.period;
    if (periods > 1) missed_ += static_cast<std::uint64_t>(periods - 1);
  }
  last_display_ = frame.display;
}

std::optional<Refresh> HeadsetScreen::next_refresh() {
  if (state_ != display::HeadsetState::Running) {
    std::this_thread::sleep_for(kIdlePause);
    return std::nullopt;
  }
  const auto frame = headset_->begin_frame();
  if (!frame) return std::nullopt;
  if (!frame->visible || !locate(*frame)) {
    headset_->end_frame(eyes_, {});
    return std::nullopt;
  }
  count_missed(*frame);
  const ClientTime now{clock_.now()};
  return Refresh{index_++, now, frame->display, now};
}

ClientTime HeadsetScreen::show(const Refresh& refresh, const WarpedEyes& eyes, const Gaze&) {
  std::vector<display::HeadsetPicture> pictures;
  for (std::size_t i = 0; i < eyes.colors.size(); ++i)
    pictures.push_back({eyes.colors[i], eyes.inverse_depths_per_m[i]});
  headset_->end_frame(eyes_, pictures);
  // The runtime holds the picture until then; one that comes late is shown with the next.
  return std::max(refresh.display, ClientTime{clock_.now()});
}

void announce(const display::Headset& headset) {
  const auto& [width_px, height_px] = headset.eye_px();
  base::log_info(base::concat("headset: ", headset.description(), ", ", width_px, "x", height_px,
                              " px an eye at ", headset.refresh_hz(), " Hz"));
  if (!headset.tracks_gaze())
    base::log_info("no eye tracker: foveation stays fixed at the centre of each eye");
}

}  // namespace

Result<std::unique_ptr<Screen>> make_headset_screen(const ClientConfig& config,
                                                    const base::Clock& clock) {
  // The loader speaks four lines to our one; who set this wants to hear them.
  ::setenv("XR_LOADER_DEBUG", "none", 0);
  auto context = display::HiddenContext::create();
  if (!context) return base::forward(context);
  display::HeadsetOptions options;
  if (config.width_px > 0) options.eye_px = {config.width_px, config.height_px};
  auto headset = display::Headset::create(options);
  if (!headset) return base::forward(headset);
  announce(**headset);
  return std::make_unique<HeadsetScreen>(std::move(*context), std::move(*headset), clock,
                                         config.convergence);
}

}  // namespace macula::client_app
