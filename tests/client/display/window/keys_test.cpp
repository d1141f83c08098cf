// Every key of the window, pressed as the X server would press it, and what is then to be seen.
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string>
#include <thread>
#include <tuple>

#include "client/display/window/window.h"
#include "tests/support/keyboard.h"

namespace macula::display {
namespace {

using image::Plane;

constexpr Rgb8 kLeft{200, 40, 40}, kRight{40, 40, 200}, kGround{18, 20, 24};
constexpr Rgb8 kSecondLeft{190, 45, 40}, kSecondRight{40, 140, 200};
constexpr const char* kTitle = "Macula keys test";

class KeysTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto window = Window::create({kTitle, 640, 240, Vsync::Off});
    if (!window) {
      ASSERT_EQ(std::getenv("MACULA_TEST_HAS_DISPLAY"), nullptr) << window.error().message();
      GTEST_SKIP() << window.error().message();
    }
    window_ = std::move(*window);
    keyboard_.emplace(kTitle);
    ASSERT_TRUE(keyboard_->found());
    show();
  }
  void show() {
    dashboard_.lines = {"pose age 12 ms"};
    dashboard_.columns = {StageColumn{1.0F, 2.0F, 3.0F}};
    Overlay overlay;
    overlay.dashboard = &dashboard_;
    // Ninety degrees across; the left eye looks straight ahead.
    overlay.marks[0].rings = EccentricityRings{{-1.0F, -0.75F},
                                               {1.0F, 0.75F},
                                               {0.0F, 0.0F, -1.0F},
                                               {Degrees{5.0}, Degrees{10.0}, Degrees{25.0}}};
    overlay.compared = &compared_;
    const std::array eyes{&left_, &right_};
    window_->show(eyes, overlay);
  }
  /// Everything that a key can change.
  auto state(const Input& input) const {
    const Choices& choices = window_->choices();
    return std::tuple{input.right,
                      input.up,
                      input.forward,
                      input.reset,
                      input.screenshot,
                      input.gaze_frozen,
                      choices.eyes,
                      choices.rings,
                      choices.dashboard,
                      choices.help,
                      window_->should_close(),
                      choices.comparison,
                      choices.swapped,
                      choices.ways};
  }
  /// A stroke, what the window says of it, and then shows. Keys take their way through the X
  /// server, so the window is polled until it has heard of them.
  Input stroke(const char* key) {
    const auto before = state(window_->poll());
    keyboard_->press(key);
    const Input input = poll_until([&](const Input& now) { return state(now) != before; });
    keyboard_->release(key);
    poll_until([](const Input& now) { return !now.right && !now.up && !now.forward; });
    show();
    return input;
  }
  template <class Condition>
  Input poll_until(const Condition& condition) {
    using namespace std::chrono_literals;
    Input input = window_->poll();
    for (int i = 0; i < 1000 && !condition(input); ++i) {
      std::this_thread::sleep_for(2ms);
      input = window_->poll();
    }
    return input;
  }
  Plane<Rgb8> shown() { return window_->capture(); }
  /// Below the lines of the comparison, at a share of the left and of the right eye's width.
  struct Shown {
    Rgb8 left, right;
  };
  Shown shown_at(double share) {
    const int x = static_cast<int>(share * 320.0);
    const auto picture = shown();
    return {picture(x, 200), picture(320 + x, 200)};
  }

  const Plane<Rgb8> left_{320, 240, kLeft}, right_{320, 240, kRight};
  const Plane<Rgb8> second_left_{320, 240, kSecondLeft}, second_right_{320, 240, kSecondRight};
  const Compared compared_{{&second_left_, &second_right_}, {"1 mesh", "2 rotation"}};
  Dashboard dashboard_;
  std::unique_ptr<Window> window_;
  std::optional<test::Keyboard> keyboard_;
};

TEST_F(KeysTest, OShowsTheFiguresAndHidesThem) {
  EXPECT_EQ(shown()(2, 2), kLeft);
  stroke("o");
  EXPECT_EQ(shown()(2, 2), kGround);
  EXPECT_EQ(shown()(639, 239), kRight);
  stroke("o");
  EXPECT_EQ(shown()(2, 2), kLeft);
}

TEST_F(KeysTest, HShowsTheKeysAndHidesThem) {
  stroke("h");
  EXPECT_EQ(shown()(2, 2), kGround);
  stroke("h");
  EXPECT_EQ(shown()(2, 2), kLeft);
}

TEST_F(KeysTest, GShowsRingsOfEqualEccentricity) {
  stroke("g");
  const auto picture = shown();
  for (const double degrees : {5.0, 10.0, 25.0}) {
    const double radius_px = 160.0 * std::tan(Radians(Degrees{degrees}).value());
    // Pixels whose middle lies nearest to the line, right of and below the gaze.
    const int right = static_cast<int>(160.0 + radius_px);
    const int below = static_cast<int>(120.0 + radius_px);
    EXPECT_EQ(picture(right, 120), (Rgb8{255, 255, 255})) << degrees;
    EXPECT_EQ(picture(160, below), (Rgb8{255, 255, 255})) << degrees;
  }
  EXPECT_EQ(picture(160, 120), kLeft);
  EXPECT_EQ(picture(480, 120), kRight);
  stroke("g");
  EXPECT_EQ(shown()(160 + 14, 120), kLeft);
}

TEST_F(KeysTest, BTakesBothEyesThenTheLeftThenTheRight) {
  stroke("b");
  EXPECT_EQ(shown()(320, 120), kLeft);
  EXPECT_EQ(shown()(0, 120), (Rgb8{}));
  stroke("b");
  EXPECT_EQ(shown()(320, 120), kRight);
  stroke("b");
  EXPECT_EQ(shown()(10, 120), kLeft);
  EXPECT_EQ(shown()(630, 120), kRight);
}

TEST_F(KeysTest, CWipesThenFlipsThenShowsTheDifferenceThenEnds) {
  EXPECT_EQ(shown_at(0.75).left, kLeft);
  stroke("c");
  EXPECT_EQ(shown()(2, 2), kGround) << "what is compared is told";
  EXPECT_EQ(shown_at(0.25).left, kLeft);
  EXPECT_EQ(shown_at(0.75).left, kSecondLeft) << "nobody has moved the cursor: from the middle on";
  EXPECT_EQ(shown_at(0.25).right, kRight);
  EXPECT_EQ(shown_at(0.75).right, kSecondRight);
  stroke("c");
  EXPECT_EQ(shown_at(0.75).left, kLeft);
  stroke("c");
  EXPECT_EQ(shown_at(0.25).left, (Rgb8{40, 20, 0})) << "four times 10, 5, 0";
  EXPECT_EQ(shown_at(0.75).right, (Rgb8{0, 255, 0})) << "four times 100 is more than there is";
  stroke("c");
  EXPECT_EQ(shown_at(0.75).left, kLeft);
  EXPECT_EQ(shown()(2, 2), kLeft);
}

TEST_F(KeysTest, XSwapsWhatIsCompared) {
  stroke("c");
  stroke("x");
  EXPECT_EQ(shown_at(0.25).left, kSecondLeft);
  EXPECT_EQ(shown_at(0.75).left, kLeft);
  stroke("c");
  EXPECT_EQ(shown_at(0.25).right, kSecondRight) << "flipped";
  stroke("x");
  EXPECT_EQ(shown_at(0.25).right, kRight);
}

TEST_F(KeysTest, OneAndTwoAskForAnotherWay) {
  stroke("1");
  stroke("2");
  stroke("2");
  EXPECT_EQ(window_->choices().ways, (std::array{1, 2}));
}

TEST_F(KeysTest, PAsksForAScreenshotOnce) {
  EXPECT_TRUE(stroke("p").screenshot);
  EXPECT_FALSE(window_->poll().screenshot);
}

TEST_F(KeysTest, FFreezesTheGazeAndReleasesIt) {
  EXPECT_TRUE(stroke("f").gaze_frozen);
  EXPECT_FALSE(stroke("f").gaze_frozen);
}

TEST_F(KeysTest, RAsksForTheStart) {
  EXPECT_TRUE(stroke("r").reset);
  EXPECT_FALSE(window_->poll().reset);
}

TEST_F(KeysTest, LettersMoveTheHeadWhileTheyAreHeld) {
  EXPECT_EQ(stroke("w").forward, 1);
  EXPECT_EQ(stroke("s").forward, -1);
  EXPECT_EQ(stroke("d").right, 1);
  EXPECT_EQ(stroke("a").right, -1);
  EXPECT_EQ(stroke("e").up, 1);
  EXPECT_EQ(stroke("q").up, -1);
  EXPECT_EQ(window_->poll().up, 0);
}

TEST_F(KeysTest, EscapeCloses) {
  EXPECT_FALSE(window_->should_close());
  stroke("Escape");
  EXPECT_TRUE(window_->should_close());
}

}  // namespace
}  // namespace macula::display
