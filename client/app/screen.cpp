#include "client/app/screen.h"

#include "client/app/window_screen.h"
#include "client/pose/demo_trace.h"
#include "client/pose/trace_source.h"

namespace macula::client_app {
namespace {

/// Nobody looks: the pictures are only kept by whoever writes them.
class HeadlessScreen final : public Screen {
 public:
  explicit HeadlessScreen(pose::AtEnd at_end) : at_end_(at_end) {}
  bool poll() override { return true; }
  void show(const display::EyePictures&, const Gaze&) override {}
  std::unique_ptr<pose::PoseSource> viewer() override {
    return std::make_unique<pose::TraceSource>(pose::make_demo_trace(), at_end_);
  }

 private:
  const pose::AtEnd at_end_;
};

}  // namespace

Result<std::unique_ptr<Screen>> make_screen(const ClientConfig& config) {
  if (config.display == DisplayKind::Window) return make_window_screen(config);
  const bool repeat = config.repeat_trace == ClientConfig::Repeat::Yes;
  return std::make_unique<HeadlessScreen>(repeat ? pose::AtEnd::Loop : pose::AtEnd::Stop);
}

}  // namespace macula::client_app
