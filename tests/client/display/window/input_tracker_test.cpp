#include "client/display/window/input_tracker.h"

#include <gtest/gtest.h>

#include <array>

namespace macula::display {
namespace {

using image::Rect;

constexpr std::array kPlaces{Rect{0, 0, 200, 100}, Rect{200, 0, 200, 100}};

Devices cursor_at(float x_px, float y_px) {
  Devices devices;
  devices.cursor_x_px = x_px;
  devices.cursor_y_px = y_px;
  return devices;
}

Devices dragging_at(float x_px, float y_px) {
  Devices devices = cursor_at(x_px, y_px);
  devices.drag_button = true;
  return devices;
}

TEST(InputTracker, GazeFollowsTheCursorAndEndsOutsideThePictures) {
  InputTracker tracker;
  const auto over = tracker.poll(cursor_at(250.0F, 25.0F), kPlaces);
  ASSERT_TRUE(over.gaze);
  EXPECT_EQ(over.gaze->picture, 1);
  EXPECT_FLOAT_EQ(over.gaze->at.u, 0.25F);
  EXPECT_FLOAT_EQ(over.gaze->at.v, 0.25F);
  EXPECT_FALSE(tracker.poll(cursor_at(250.0F, 120.0F), kPlaces).gaze);
}

TEST(InputTracker, AFrozenGazeStaysUntilReleased) {
  InputTracker tracker;
  tracker.poll(cursor_at(50.0F, 50.0F), kPlaces);
  tracker.toggle_freeze();
  const auto frozen = tracker.poll(cursor_at(350.0F, 90.0F), kPlaces);
  EXPECT_TRUE(frozen.gaze_frozen);
  ASSERT_TRUE(frozen.gaze);
  EXPECT_EQ(frozen.gaze->picture, 0);
  EXPECT_FLOAT_EQ(frozen.gaze->at.u, 0.25F);
  tracker.toggle_freeze();
  EXPECT_EQ(tracker.poll(cursor_at(350.0F, 90.0F), kPlaces).gaze->picture, 1);
}

TEST(InputTracker, DragCountsOnlyMovementWithTheButtonHeld) {
  InputTracker tracker;
  EXPECT_EQ(tracker.poll(cursor_at(0.0F, 0.0F), kPlaces).drag.u, 0.0F);
  EXPECT_EQ(tracker.poll(dragging_at(100.0F, 50.0F), kPlaces).drag.u, 0.0F);  // it starts here
  const auto moved = tracker.poll(dragging_at(120.0F, 40.0F), kPlaces).drag;
  EXPECT_FLOAT_EQ(moved.u, 0.1F);   // 20 of 200 px
  EXPECT_FLOAT_EQ(moved.v, -0.1F);  // 10 of 100 px, upwards
  EXPECT_EQ(tracker.poll(cursor_at(150.0F, 40.0F), kPlaces).drag.u, 0.0F);
  EXPECT_EQ(tracker.poll(dragging_at(10.0F, 10.0F), kPlaces).drag.u, 0.0F);  // a new drag
}

TEST(InputTracker, DragWithoutPicturesIsNothing) {
  InputTracker tracker;
  tracker.poll(dragging_at(0.0F, 0.0F), {});
  EXPECT_EQ(tracker.poll(dragging_at(9.0F, 9.0F), {}).drag.u, 0.0F);
}

TEST(InputTracker, OpposedKeysCancel) {
  InputTracker tracker;
  Devices devices;
  devices.forward = devices.left = devices.right = devices.down = true;
  const auto input = tracker.poll(devices, kPlaces);
  EXPECT_EQ(input.forward, 1);
  EXPECT_EQ(input.right, 0);
  EXPECT_EQ(input.up, -1);
}

TEST(InputTracker, AResetIsToldOnce) {
  InputTracker tracker;
  tracker.request_reset();
  EXPECT_TRUE(tracker.poll({}, kPlaces).reset);
  EXPECT_FALSE(tracker.poll({}, kPlaces).reset);
}

}  // namespace
}  // namespace macula::display
