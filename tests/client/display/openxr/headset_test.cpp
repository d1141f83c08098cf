#include "client/display/openxr/headset.h"

#include <algorithm>
#include <cmath>

#include "shared/base/clock.h"
#include "tests/support/null_runtime/null_headset.h"

namespace macula::display {
namespace {

using image::Plane;

ClientTime now() {
  return ClientTime{base::SteadyClock().now()};
}

/// Differs from its neighbours, from its mirror images and between the eyes.
Plane<Rgb8> known_picture(PictureSize size, std::uint8_t blue) {
  Plane<Rgb8> picture(size.width_px, size.height_px);
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x)
      picture(x, y) = {static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(2 * y), blue};
  return picture;
}

/// 0 to 2 per meter, from top to bottom.
Plane<float> known_depth(PictureSize size) {
  Plane<float> depth(size.width_px, size.height_px);
  for (int y = 0; y < depth.height(); ++y)
    for (float& value : depth.row(y)) value = 2.0F * static_cast<float>(y) / 80.0F;
  return depth;
}

class HeadsetTest : public test::NullHeadsetTest {
 protected:
  void SetUp() override {
    NullHeadsetTest::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    context_ = std::move(*HiddenContext::create());
  }
  void TearDown() override {
    headset_.reset();
    context_.reset();
    if (!IsSkipped()) NullHeadsetTest::TearDown();
  }
  void open(const HeadsetOptions& options = {}) {
    auto headset = Headset::create(options);
    ASSERT_TRUE(headset) << headset.error().message();
    headset_ = std::move(*headset);
  }
  /// Polls until a frame begins that would be seen.
  HeadsetFrame begin_visible_frame() {
    while (true) {
      EXPECT_EQ(headset_->poll(), HeadsetState::Running);
      const auto frame = headset_->begin_frame();
      EXPECT_TRUE(frame);
      if (frame->visible) return *frame;
      headset_->end_frame({}, {});
    }
  }
  void show(const Plane<Rgb8>& left, const Plane<Rgb8>& right, const Plane<float>& depth) {
    const HeadsetFrame frame = begin_visible_frame();
    const auto eyes = headset_->eyes(frame.display);
    ASSERT_TRUE(eyes);
    const std::array pictures{HeadsetPicture{left, depth}, HeadsetPicture{right, depth}};
    headset_->end_frame(*eyes, pictures);
  }
  std::string refusal() {
    const auto headset = Headset::create({});
    EXPECT_FALSE(headset);
    return headset ? "" : headset.error().message();
  }

  std::unique_ptr<HiddenContext> context_;
  std::unique_ptr<Headset> headset_;
};

TEST_F(HeadsetTest, SaysWhoItIsAndWhatItShows) {
  runtime_.script.refresh_hz = 90.0;
  open();
  EXPECT_EQ(headset_->description(), "Macula's null runtime 1.2.3, Null headset");
  EXPECT_EQ(headset_->eye_px(), (PictureSize{96, 80}));
  EXPECT_NEAR(headset_->refresh_hz(), 90.0, 1e-3);
  EXPECT_FALSE(headset_->tracks_gaze());
}

TEST_F(HeadsetTest, TakesTheSizeAskedForUpToWhatTheRuntimeAllows) {
  open({.eye_px = PictureSize{1000, 120}});
  EXPECT_EQ(headset_->eye_px(), (PictureSize{512, 120}));
}

TEST_F(HeadsetTest, PutsPicturesAndDepthIntoTheRuntimesTexturesUnchanged) {
  runtime_.script.capture_every = 1;
  open();
  const auto left = known_picture(headset_->eye_px(), 10);
  const auto right = known_picture(headset_->eye_px(), 200);
  const auto depth = known_depth(headset_->eye_px());
  for (int frame = 0; frame < 4; ++frame) show(left, right, depth);
  const test::NullFrame& shown = runtime_.frames.back();
  ASSERT_TRUE(shown.has_layer && shown.has_depth);
  for (int y = 0; y < 80; ++y)
    for (int x = 0; x < 96; ++x) {
      // OpenGL's rows go up.
      const std::size_t at = static_cast<std::size_t>(79 - y) * 96 + static_cast<std::size_t>(x);
      for (const auto& [eye, picture] : {std::pair{0, &left}, std::pair{1, &right}}) {
        const std::uint8_t* const rgba = &shown.rgba[static_cast<std::size_t>(eye)][4 * at];
        ASSERT_EQ((Rgb8{rgba[0], rgba[1], rgba[2]}), (*picture)(x, y)) << eye << x << ", " << y;
      }
      // What the layer says of its depth must give the distance back: between nearZ at minDepth
      // and farZ at maxDepth the inverse distance runs evenly.
      const float share =
          (shown.depth[0][at] - shown.min_depth) / (shown.max_depth - shown.min_depth);
      const float inverse = (1.0F - share) / shown.near_z + share / shown.far_z;
      ASSERT_NEAR(inverse, depth(x, y), 1e-5F) << y;
    }
}

TEST_F(HeadsetTest, ShowsWithoutDepthWhereTheRuntimeTakesNone) {
  runtime_.script.offers_depth = false;
  open();
  EXPECT_FALSE(headset_->takes_depth());
  const auto picture = known_picture(headset_->eye_px(), 10);
  show(picture, picture, known_depth(headset_->eye_px()));
  EXPECT_TRUE(runtime_.frames.back().has_layer);
  EXPECT_FALSE(runtime_.frames.back().has_depth);
}

TEST_F(HeadsetTest, KnowsTheEyesTheirFieldsOfViewAndTheHead) {
  const float half = std::sqrt(0.5F);
  runtime_.script.heads = {{0, {1.0F, 1.5F, -2.0F, 0.0F, half, 0.0F, half}}};  // turned left
  runtime_.script.fov = {test::NullFov{-0.9F, 0.7F, 0.8F, -0.6F},
                         test::NullFov{-0.7F, 0.9F, 0.8F, -0.6F}};
  open();
  const auto eyes = headset_->eyes(now());
  ASSERT_TRUE(eyes);
  // The left eye, 3 cm to the left of a head that looks along -x, lies towards +z.
  EXPECT_NEAR((*eyes)[0].stage_from_eye.position.z, -2.0 + 0.03, 1e-6);
  EXPECT_NEAR((*eyes)[1].stage_from_eye.position.z, -2.0 - 0.03, 1e-6);
  EXPECT_NEAR((*eyes)[0].fov.left.value(), -0.9, 1e-6);
  EXPECT_NEAR((*eyes)[1].fov.right.value(), 0.9, 1e-6);
  const auto head = headset_->stage_from_head(now());
  ASSERT_TRUE(head);
  EXPECT_NEAR(head->position.x, 1.0, 1e-6);
  EXPECT_NEAR(head->transform_direction({0.0, 0.0, -1.0}).x, -1.0, 1e-6);
}

TEST_F(HeadsetTest, PassesOnTheGazeWithTheTrackersOwnTime) {
  const float half = std::sin(0.1F);
  runtime_.script.gazes = {{0, true, {0, 0, 0, 0.0F, half, 0.0F, std::cos(0.1F)}}};
  open();
  ASSERT_TRUE(headset_->tracks_gaze());
  begin_visible_frame();
  headset_->end_frame({}, {});
  headset_->poll();
  const ClientTime at = now();
  const HeadsetGaze gaze = headset_->gaze(at);
  EXPECT_TRUE(gaze.gaze.valid);
  EXPECT_NEAR(gaze.gaze.direction.x, -std::sin(0.2F), 1e-6F);
  EXPECT_EQ(at - gaze.at, std::chrono::milliseconds{4});
}

TEST_F(HeadsetTest, ABlinkIsAGazeThatIsNotValid) {
  runtime_.script.gazes = {{0, false, {}}};
  open();
  begin_visible_frame();
  EXPECT_FALSE(headset_->gaze(now()).gaze.valid);
}

TEST_F(HeadsetTest, PredictsDisplayTimesOnTheClientsOwnClock) {
  open();
  const ClientTime before = now();
  const HeadsetFrame frame = begin_visible_frame();
  EXPECT_GT(frame.display, before);
  EXPECT_LT(frame.display - before, std::chrono::seconds{10});
  EXPECT_NEAR(units::to_s(frame.period), 1.0 / 60.0, 1e-6);
}

TEST_F(HeadsetTest, ClosesWhenTheRuntimeEndsTheSession) {
  runtime_.script.stop_at_frame = 5;
  open();
  HeadsetState state = HeadsetState::Running;
  for (int i = 0; i < 100 && state != HeadsetState::Closed; ++i) {
    if (state == HeadsetState::Running && headset_->begin_frame()) headset_->end_frame({}, {});
    state = headset_->poll();
  }
  EXPECT_EQ(state, HeadsetState::Closed);
}

TEST_F(HeadsetTest, SaysThatTheRuntimeIsGoneInsteadOfWaitingForIt) {
  runtime_.script.lose_at_frame = 4;
  open();
  HeadsetState state = HeadsetState::Running;
  int frames = 0;
  while (state == HeadsetState::Running && frames < 100) {
    if (headset_->begin_frame()) headset_->end_frame({}, {});
    state = headset_->poll();
    ++frames;
  }
  EXPECT_EQ(state, HeadsetState::Lost);
  EXPECT_LT(frames, 10);
}

TEST_F(HeadsetTest, StandsOnTheFloorWhereTheRuntimeHasNoStage) {
  runtime_.script.has_stage = false;
  open();
  EXPECT_TRUE(headset_->stage_from_head(now()));
}

TEST_F(HeadsetTest, NamesWhatIsMissing) {
  runtime_.script.has_headset = false;
  EXPECT_EQ(refusal(),
            "OpenXR: Macula's null runtime has no headset: XR_ERROR_FORM_FACTOR_UNAVAILABLE "
            "(connect and switch it on, or use --display window)");
  runtime_.script.has_headset = true;
  runtime_.script.offers_opengl = false;
  EXPECT_EQ(refusal(),
            "OpenXR: the runtime does not offer XR_KHR_opengl_enable (use another runtime, or "
            "--display window)");
}

}  // namespace
}  // namespace macula::display
