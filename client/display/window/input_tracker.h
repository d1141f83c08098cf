// From keys, buttons and cursor positions to Input. Knows no window library; remembers what Input
// needs from one poll to the next: the frozen gaze, where a drag was, what was pressed in between.
#pragma once

#include <optional>
#include <span>

#include "client/display/window/input.h"
#include "shared/image/plane.h"

namespace macula::display {

/// The state of the devices at one moment. The cursor is in framebuffer pixels from the top left.
struct Devices {
  float cursor_x_px = 0.0F, cursor_y_px = 0.0F;
  bool drag_button = false;
  bool left = false, right = false, down = false, up = false, back = false, forward = false;
};

class InputTracker {
 public:
  void toggle_freeze() { frozen_ = !frozen_; }
  void request_reset() { reset_ = true; }
  void request_screenshot() { screenshot_ = true; }
  /// `places` are the pictures' rectangles (layout.h).
  Input poll(const Devices& devices, std::span<const image::Rect> places);

 private:
  struct Cursor {
    float x_px, y_px;
  };
  PicturePoint drag_since_last(const Devices& devices, std::span<const image::Rect> places);

  std::optional<PictureTarget> gaze_;
  std::optional<Cursor> drag_from_;
  bool frozen_ = false, reset_ = false, screenshot_ = false;
};

}  // namespace macula::display
