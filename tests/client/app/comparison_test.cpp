#include "client/app/comparison.h"

#include <gtest/gtest.h>

#include <thread>

#include "tests/client/frames/encoded_frames.h"

namespace macula::client_app {
namespace {

/// A frame of known pixels, two meters away, seen from `position`.
frames::FramePtr frame_at(std::uint64_t number, const DVec3& position) {
  const base::ManualClock clock;
  auto received = test::make_received_frame(1, number);
  for (net::FrameView& view : received.begin.views) view.stage_from_view.position = position;
  auto decoded = frames::FrameDecoder(clock).decode(std::move(received));
  return std::make_shared<frames::DecodedFrame>(std::move(*decoded));
}

int way_named(const std::string& name) {
  const auto ways = Comparison::ways();
  for (std::size_t i = 0; i < ways.size(); ++i) {
    if (ways[i].name == name) return static_cast<int>(i);
  }
  ADD_FAILURE() << "no way " << name;
  return 0;
}

class ComparisonTest : public testing::Test {
 protected:
  static constexpr double kStep_m = 0.3;

  void hold_beside() { comparison_.hold({{kStep_m, 0.0, 0.0}, DQuat{1, 0, 0, 0}}); }
  void update(const frames::FramePtr& newest, const char* first, const char* second) {
    comparison_.update(newest, rig_, {way_named(first), way_named(second)});
  }
  bool same_pictures() const {
    const auto a = comparison_.pictures(0)[0].pixels(), b = comparison_.pictures(1)[0].pixels();
    return std::equal(a.begin(), a.end(), b.begin());
  }
  /// The line of the metrics, once it is there.
  std::string metrics() {
    for (int i = 0; i < 2000; ++i) {
      const std::string line = comparison_.lines()[2];
      if (line.starts_with("psnr ")) {
        if (line.find("flip 0") != std::string::npos) return line;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds{5});
    }
    return "never";
  }

  const EyeRig rig_ = EyeRig::side_by_side(test::small_display(), 2, Meters{0.0}, Meters{1.0});
  const frames::FramePtr old_ = frame_at(1, {}), beside_ = frame_at(2, {kStep_m, 0.0, 0.0});
  Comparison comparison_;
};

TEST_F(ComparisonTest, HoldsTheHeadWhereItFirstWasUntilItEnds) {
  hold_beside();
  EXPECT_EQ(comparison_.hold({}).position.x, kStep_m);
  comparison_.end();
  EXPECT_FALSE(comparison_.holds());
  EXPECT_EQ(comparison_.hold({}).position.x, 0.0);
}

TEST_F(ComparisonTest, ShowsTheHeldFrameInTwoWaysAndSaysHowTheyDiffer) {
  hold_beside();
  update(old_, "mesh", "rotation");
  EXPECT_FALSE(same_pictures()) << "rotation knows no step aside";
  const auto lines = comparison_.lines();
  EXPECT_TRUE(lines[0].starts_with("1  mesh ")) << lines[0];
  EXPECT_TRUE(lines[1].starts_with("2  rotation ")) << lines[1];
  EXPECT_EQ(metrics().find("flip 0.0000"), std::string::npos);
}

TEST_F(ComparisonTest, SaysThatThereIsNoDifferenceWhereThereIsNone) {
  hold_beside();
  update(old_, "mesh", "mesh");
  EXPECT_TRUE(same_pictures());
  EXPECT_NE(metrics().find("flip 0.0000"), std::string::npos);
}

TEST_F(ComparisonTest, KeepsTheFrameItBeganWithWhileNewOnesCome) {
  hold_beside();
  update(old_, "mesh", "rotation");
  const auto first = comparison_.pictures(0)[0];
  update(beside_, "mesh", "as it came");
  update(beside_, "mesh", "rotation");
  EXPECT_TRUE(std::equal(first.pixels().begin(), first.pixels().end(),
                         comparison_.pictures(0)[0].pixels().begin()));
  EXPECT_FALSE(same_pictures());
}

TEST_F(ComparisonTest, TakesTheNewestFrameWhereThatIsAskedFor) {
  hold_beside();
  update(old_, "mesh", "rotation");
  update(beside_, "mesh", "mesh, newest frame");
  const auto& shown = comparison_.pictures(1)[0];
  EXPECT_EQ(shown(7, 9), (Rgb8{7, 9, 0})) << "a frame of this very view: its pixels as they are";
}

TEST_F(ComparisonTest, CountsWaysRound) {
  hold_beside();
  const int count = static_cast<int>(Comparison::ways().size());
  comparison_.update(old_, rig_, {count, count + Comparison::first_of_second_side()});
  EXPECT_TRUE(comparison_.lines()[0].starts_with("1  mesh "));
  EXPECT_TRUE(comparison_.lines()[1].starts_with("2  rotation "));
}

}  // namespace
}  // namespace macula::client_app
