#include "client/display/window/input_tracker.h"

#include <utility>

#include "client/display/window/layout.h"

namespace macula::display {
namespace {

int axis(bool negative, bool positive) {
  return (positive ? 1 : 0) - (negative ? 1 : 0);
}

}  // namespace

Input InputTracker::poll(const Devices& devices, std::span<const image::Rect> places) {
  if (!frozen_) gaze_ = picture_at(places, devices.cursor_x_px, devices.cursor_y_px);
  Input input;
  input.gaze = gaze_;
  input.gaze_frozen = frozen_;
  input.drag = drag_since_last(devices, places);
  input.right = axis(devices.left, devices.right);
  input.up = axis(devices.down, devices.up);
  input.forward = axis(devices.back, devices.forward);
  input.reset = std::exchange(reset_, false);
  input.screenshot = std::exchange(screenshot_, false);
  return input;
}

PicturePoint InputTracker::drag_since_last(const Devices& devices,
                                           std::span<const image::Rect> places) {
  const Cursor now{devices.cursor_x_px, devices.cursor_y_px};
  const auto from =
      std::exchange(drag_from_, devices.drag_button ? std::optional(now) : std::nullopt);
  if (!from || !drag_from_ || places.empty()) return {};
  const auto& picture = places.front();  // all pictures have one scale
  if (picture.width <= 0 || picture.height <= 0) return {};
  return {(now.x_px - from->x_px) / static_cast<float>(picture.width),
          (now.y_px - from->y_px) / static_cast<float>(picture.height)};
}

}  // namespace macula::display
