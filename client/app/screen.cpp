#include "client/app/screen.h"

#include "client/app/headset_screen.h"
#include "client/app/window_screen.h"
#include "client/pose/demo_trace.h"
#include "client/pose/trace_source.h"

namespace macula::client_app {
namespace {

/// Nobody looks: the pictures are only kept by whoever writes them.
class HeadlessScreen final : public ClockedScreen {
 public:
  HeadlessScreen(const ClientConfig& config, const base::Clock& clock)
      : ClockedScreen(config, clock),
        at_end_(config.repeat_trace == ClientConfig::Repeat::Yes ? pose::AtEnd::Loop
                                                                 : pose::AtEnd::Stop) {}
  std::optional<display::RunEnd> poll() override { return std::nullopt; }
  std::unique_ptr<pose::PoseSource> viewer() override {
    return std::make_unique<pose::TraceSource>(pose::make_demo_trace(), at_end_);
  }

 private:
  void present(const display::EyePictures&, const Gaze&) override {}

  const pose::AtEnd at_end_;
};

}  // namespace

ClockedScreen::ClockedScreen(const ClientConfig& config, const base::Clock& clock)
    : refresh_hz_(config.refresh_hz),
      pacing_(config.pacing),
      clock_(clock),
      rig_(eye_rig(config)) {}

std::optional<Refresh> ClockedScreen::next_refresh() {
  if (!refreshes_) refreshes_.emplace(clock_, refresh_hz_, pacing_);
  return refreshes_->next();
}

ClientTime ClockedScreen::show(const Refresh& refresh, const WarpedEyes& eyes,
                               const Gaze& head_gaze) {
  refreshes_->wait_for_display(refresh);
  present(eyes.colors, head_gaze);
  return ClientTime{clock_.now()};
}

void ClockedScreen::skip(const Refresh& refresh) {
  refreshes_->wait_for_display(refresh);
}

std::uint64_t ClockedScreen::missed_refreshes() const {
  return refreshes_ ? refreshes_->missed() : 0;
}

Result<std::unique_ptr<Screen>> make_screen(const ClientConfig& config, const base::Clock& clock) {
  switch (config.display) {
    case DisplayKind::Window:
      return make_window_screen(config, clock);
    case DisplayKind::OpenXr:
      return make_headset_screen(config, clock);
    case DisplayKind::Headless:
      break;
  }
  return std::make_unique<HeadlessScreen>(config, clock);
}

}  // namespace macula::client_app
