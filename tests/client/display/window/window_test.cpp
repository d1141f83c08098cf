#include "client/display/window/window.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <string>

#include "shared/image/png.h"

namespace macula::display {
namespace {

using image::Plane;

/// A picture in which every pixel differs from its neighbours and from its mirror images.
Plane<Rgb8> known_picture(int width, int height, std::uint8_t blue) {
  Plane<Rgb8> picture(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      picture(x, y) = {static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(2 * y), blue};
  return picture;
}

class WindowTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto window = Window::create({"Macula test", 320, 120, Vsync::Off});
    if (window) {
      window_ = std::move(*window);
      return;
    }
    ASSERT_EQ(std::getenv("MACULA_TEST_HAS_DISPLAY"), nullptr) << window.error().message();
    GTEST_SKIP() << window.error().message();
  }
  void show(const Plane<Rgb8>& left, const Plane<Rgb8>& right, const Overlay& overlay = {}) {
    const std::array eyes{&left, &right};
    window_->show(eyes, overlay);
  }
  std::unique_ptr<Window> window_;
};

TEST_F(WindowTest, ShowsBothEyesPixelByPixelWhereTheyFit) {
  const auto left = known_picture(160, 120, 10), right = known_picture(160, 120, 200);
  for (int frame = 0; frame < 3; ++frame) {
    show(left, right);
    window_->poll();
  }
  const auto shown = window_->capture();
  ASSERT_EQ(shown.rect(), (image::Rect{0, 0, 320, 120}));
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 160; ++x) {
      ASSERT_EQ(shown(x, y), left(x, y)) << x << ", " << y;
      ASSERT_EQ(shown(160 + x, y), right(x, y)) << x << ", " << y;
    }
}

TEST_F(WindowTest, KeepsTheAspectOfOneEyeBetweenBlackBars) {
  const Plane<Rgb8> flat(50, 50, Rgb8{30, 144, 255});
  const std::array eyes{&flat};
  window_->show(eyes);
  const auto shown = window_->capture();
  for (int x = 0; x < 320; ++x)
    EXPECT_EQ(shown(x, 60), (x >= 100 && x < 220 ? Rgb8{30, 144, 255} : Rgb8{})) << x;
}

TEST_F(WindowTest, PicturesMayChangeSizeBetweenFrames) {
  show(known_picture(160, 120, 1), known_picture(160, 120, 2));
  show(known_picture(80, 60, 3), known_picture(80, 60, 4));
  EXPECT_EQ(window_->capture()(319, 119).b, 4);
  const auto left = known_picture(160, 120, 5), right = known_picture(160, 120, 6);
  show(left, right);
  const auto shown = window_->capture();
  EXPECT_EQ(shown(70, 30), left(70, 30));
  EXPECT_EQ(shown(230, 30), right(70, 30));
}

TEST_F(WindowTest, TheRingStandsAroundTheGazeOfItsEyeOnly) {
  const Plane<Rgb8> flat(160, 120, Rgb8{90, 90, 90});
  Overlay overlay;
  overlay.marks[1].gaze = PicturePoint{0.25F, 0.75F};  // pixel (40, 90) of the right eye
  show(flat, flat, overlay);
  const auto shown = window_->capture();
  if (const char* folder = std::getenv("MACULA_TEST_KEEP")) {
    EXPECT_TRUE(image::write_png(std::string(folder) + "/window_ring.png", shown));
  }
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 320; ++x) {
      const double off = std::abs(std::hypot(x + 0.5 - 200.0, y + 0.5 - 90.0) - 14.0);
      if (off < 1.0) {
        EXPECT_EQ(shown(x, y), (Rgb8{255, 255, 255})) << x << ", " << y;
      }
      if (off > 3.0) {
        EXPECT_EQ(shown(x, y), (Rgb8{90, 90, 90})) << x << ", " << y;
      }
    }
}

TEST_F(WindowTest, StaysOpenAndAtRestWhenNobodyTouchesIt) {
  const auto picture = known_picture(160, 120, 0);
  show(picture, picture);
  const Input input = window_->poll();
  EXPECT_FALSE(window_->should_close());
  EXPECT_EQ(input.forward, 0);
  EXPECT_EQ(input.drag.u, 0.0F);
  EXPECT_FALSE(input.gaze_frozen);
}

TEST_F(WindowTest, AnotherCanBeOpenedAfterItCloses) {
  window_.reset();
  const auto again = Window::create({"Macula test", 64, 64, Vsync::Off});
  EXPECT_TRUE(again) << again.error().message();
}

TEST(WindowWithoutDisplay, IsAnErrorThatNamesTheWayOut) {
  const char* display = std::getenv("DISPLAY");
  const std::string before = display ? display : "";
  unsetenv("DISPLAY");
  const auto window = Window::create({});
  if (!before.empty()) setenv("DISPLAY", before.c_str(), 1);
  ASSERT_FALSE(window);
  EXPECT_NE(window.error().message().find("--display headless"), std::string::npos);
}

}  // namespace
}  // namespace macula::display
