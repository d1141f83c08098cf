// Screen: where warped pictures go, and what comes back from there. One thread.
#pragma once

#include <memory>

#include "client/app/client_config.h"
#include "client/display/headless/picture_writer.h"
#include "client/pose/pose_source.h"
#include "shared/base/result.h"

namespace macula::client_app {

class Screen {
 public:
  virtual ~Screen() = default;
  /// Before each refresh: takes what the person did; false when they asked to end.
  virtual bool poll() = 0;
  /// Shows one refresh and where the head's gaze is.
  virtual void show(const display::EyePictures& eyes, const Gaze& head_gaze) = 0;
  /// What drives the head when no trace does; it must not outlive the screen.
  virtual std::unique_ptr<pose::PoseSource> viewer() = 0;
};

/// Errors: the window cannot be opened.
Result<std::unique_ptr<Screen>> make_screen(const ClientConfig& config);

}  // namespace macula::client_app
