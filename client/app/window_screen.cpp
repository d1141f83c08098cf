#include "client/app/window_screen.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <span>
#include <utility>

#include "client/app/vitals.h"
#include "client/display/window/window.h"
#include "client/pose/interactive_source.h"
#include "shared/base/clock.h"
#include "shared/base/log.h"
#include "shared/base/text.h"
#include "shared/image/png.h"
#include "shared/math/frames.h"

namespace macula::client_app {
namespace {

constexpr double kWalk_m_per_s = 1.5;
/// A stall of the loop must not become a leap.
constexpr double kLongestStep_s = 0.1;

DVec2 frustum_size(const foveation::Display& display) {
  return display.fov.tangent_max() - display.fov.tangent_min();
}

std::optional<display::PicturePoint> picture_point(const foveation::Display& display,
                                                   const Gaze& gaze) {
  if (!gaze.valid || !(gaze.direction.z < 0.0F)) return std::nullopt;
  const DVec2 at =
      (DVec2(math::tangent_from_direction(gaze.direction)) - display.fov.tangent_min()) /
      frustum_size(display);
  return display::PicturePoint{static_cast<float>(at.x), static_cast<float>(at.y)};
}

display::PictureMarks marks_of(const foveation::Display& display, const Gaze& gaze) {
  display::PictureMarks marks;
  marks.gaze = picture_point(display, gaze);
  if (!gaze.valid) return marks;
  marks.rings = {Vec2(display.fov.tangent_min()),
                 Vec2(display.fov.tangent_max()),
                 gaze.direction,
                 {Degrees{5.0}, Degrees{10.0}, Degrees{25.0}}};
  return marks;
}

/// Hands out the head that the window steers.
class Viewer final : public pose::PoseSource {
 public:
  explicit Viewer(pose::InteractiveSource& head) : head_(head) {}
  std::optional<pose::HeadSample> sample(ClientTime at) override { return head_.sample(at); }

 private:
  pose::InteractiveSource& head_;
};

class WindowScreen final : public ClockedScreen {
 public:
  WindowScreen(std::unique_ptr<display::Window> window, const ClientConfig& config,
               const base::Clock& clock)
      : ClockedScreen(config, clock),
        window_(std::move(window)),
        clock_(clock),
        screenshots_(config.out_folder.empty() ? "." : config.out_folder) {}

  std::optional<display::RunEnd> poll() override {
    const display::Input input = window_->poll();
    head_.steer(steering(input));
    if (input.screenshot) take_screenshot();
    if (window_->should_close()) return display::RunEnd::WindowClosed;
    return std::nullopt;
  }
  void note(const Showing& showing, const RunLog& log,
            const net::ClientEndpoint& endpoint) override {
    vitals_.note(showing, log, endpoint);
  }
  std::optional<std::array<int, 2>> compared_ways() const override {
    const display::Choices& choices = window_->choices();
    if (choices.comparison == display::ComparisonView::Off) return std::nullopt;
    const auto& [first, second] = choices.ways;
    return std::array{first, Comparison::first_of_second_side() + second};
  }
  void compare(Comparison* comparison) override { comparison_ = comparison; }
  std::unique_ptr<pose::PoseSource> viewer() override { return std::make_unique<Viewer>(head_); }

 private:
  void present(const display::EyePictures& eyes, const Gaze& head_gaze) override;
  pose::Steering steering(const display::Input& input);
  void take_screenshot();
  double step_s();

  std::unique_ptr<display::Window> window_;
  const base::Clock& clock_;
  const std::filesystem::path screenshots_;
  pose::InteractiveSource head_;
  Vitals vitals_;
  Comparison* comparison_ = nullptr;  ///< what is shown instead
  Nanoseconds last_poll_ = clock_.now();
};

/// The next free name, so that nothing is overwritten.
void WindowScreen::take_screenshot() {
  std::error_code none;
  std::filesystem::create_directories(screenshots_, none);
  std::filesystem::path path;
  for (int number = 1; path.empty() || std::filesystem::exists(path, none); ++number)
    path = screenshots_ / base::concat("macula-screenshot-", number, ".png");
  const auto written = image::write_png(path.string(), window_->capture());
  if (written) {
    base::log_info("screenshot: " + path.string());
  } else {
    base::log_warning("no screenshot: " + written.error().message());
  }
}

double WindowScreen::step_s() {
  const Nanoseconds now = clock_.now();
  const double step = units::to_s(now - std::exchange(last_poll_, now));
  return std::min(step, kLongestStep_s);
}

pose::Steering WindowScreen::steering(const display::Input& input) {
  pose::Steering steering;
  const foveation::Display& screen = rig().eyes.front().display;  // as every eye's
  const Fov& fov = screen.fov;
  steering.turn_left = -static_cast<double>(input.drag.u) * (fov.right - fov.left);
  steering.turn_up = -static_cast<double>(input.drag.v) * (fov.up - fov.down);
  steering.move_m = kWalk_m_per_s * step_s() * DVec3(input.right, input.up, -input.forward);
  if (input.reset) steering.reset = pose::Steering::Reset::Yes;
  const auto picture = input.gaze ? static_cast<std::size_t>(input.gaze->picture) : 0;
  if (input.gaze && picture < rig().eyes.size()) {
    const DVec2 tangent =
        fov.tangent_min() + frustum_size(screen) * DVec2(input.gaze->at.u, input.gaze->at.v);
    steering.gaze_tangent =
        DVec2(math::tangent_from_direction(rig().head_gaze_through(picture, tangent)));
  }
  return steering;
}

void WindowScreen::present(const display::EyePictures& eyes, const Gaze& head_gaze) {
  std::array<const image::Plane<Rgb8>*, 2> pictures{};
  display::Overlay overlay;
  display::Compared compared;
  const std::size_t count = std::min(eyes.size(), pictures.size());
  for (std::size_t eye = 0; eye < count; ++eye) {
    pictures[eye] = comparison_ != nullptr ? &comparison_->pictures(0)[eye] : &eyes[eye];
    if (comparison_ != nullptr) compared.second[eye] = &comparison_->pictures(1)[eye];
    overlay.marks[eye] = marks_of(rig().eyes[eye].display, rig().gaze_of(eye, head_gaze));
  }
  overlay.dashboard = &vitals_.dashboard();
  if (comparison_ != nullptr) {
    compared.lines = comparison_->lines();
    overlay.compared = &compared;
  }
  window_->show(std::span(pictures).first(count), overlay);
}

}  // namespace

Result<std::unique_ptr<Screen>> make_window_screen(const ClientConfig& config,
                                                   const base::Clock& clock) {
  display::WindowOptions options;
  options.width_px = config.eyes * config.width_px;
  options.height_px = config.height_px;
  options.vsync = display::Vsync::Off;  // the refresh clock sets the pace
  auto window = display::Window::create(options);
  if (!window) return base::forward(window);
  return std::make_unique<WindowScreen>(std::move(*window), config, clock);
}

}  // namespace macula::client_app
