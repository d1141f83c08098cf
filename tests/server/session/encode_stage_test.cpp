// H.264 through the encode stage: what leans on what, and where bytes go around a saccade.
#include "server/session/encode_stage.h"

#include <gtest/gtest.h>

#include <cmath>

#include "shared/foveation/pixel_grid.h"
#include "tests/server/session/session_fixtures.h"

namespace macula::session {
namespace {

using foveation::GazePhase;

class EncodeStageTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!codec::can_encode_h264()) GTEST_SKIP() << "this build has no H.264";
    setup_.settings.color_codec = "h264";
  }
  /// A frame of a waving wall, rendered around a gaze that many degrees to the right.
  FrameJob job(GazePhase phase, double yaw_deg = 0.0) {
    FrameJob job;
    job.start.key = {1, 7, ++frame_};
    job.start.view = test::view(frame_);
    job.start.view_received = test::at_ms(14.0 * static_cast<double>(frame_));
    job.start.setup = std::make_shared<const ClientSetup>(setup_);
    job.encode_memory = memory_;
    const double yaw = Radians{Degrees{yaw_deg}}.value();
    const Gaze gaze{Vec3(DVec3{std::sin(yaw), 0.0, -std::cos(yaw)})};
    const foveation::Display display{test::small_display().fov, 256, 256};
    for (int eye = 0; eye < 2; ++eye) {
      kernels::View view;
      view.grid = foveation::make_foveal_grid(display, gaze, {});
      view.gaze = gaze;
      job.start.gazes.push_back({gaze, gaze, Degrees{5.0}, phase});
      job.buffers.views.push_back(waving(view.grid));
      job.views.push_back(std::move(view));
    }
    job.cells = 2 * job.buffers.views[0].radiance.size();
    return job;
  }
  net::FrameBegin encoded(FrameJob job) {
    auto frame = stage_.encode(job);
    EXPECT_TRUE(frame) << frame.error().message();
    color_bytes_ = job.encoded.color_bytes;
    return frame ? std::move(frame->begin) : net::FrameBegin{};
  }
  kernels::ViewBuffers waving(const PixelGrid& grid) const {
    kernels::ViewBuffers buffers;
    buffers.radiance.resize(grid.width(), grid.height(), Rgb{0.0F});
    buffers.depth_m.resize(grid.width(), grid.height(), 2.0F);
    for (int y = 0; y < grid.height(); ++y) {
      for (int x = 0; x < grid.width(); ++x) {
        const Vec2 at = 90.0F * grid.tangent(x, y);
        const auto shift = static_cast<float>(frame_);
        buffers.radiance(x, y) = Rgb{0.4F + 0.2F * std::sin(at.x + shift) * std::sin(1.3F * at.y)};
      }
    }
    return buffers;
  }

  ServerConfig config_;
  base::SteadyClock clock_;
  EncodeStage stage_{config_, clock_};
  ClientSetup setup_ = test::setup();
  std::shared_ptr<EncodeMemory> memory_ = std::make_shared<EncodeMemory>();
  std::uint64_t frame_ = 0;
  std::size_t color_bytes_ = 0;  ///< of the last frame
};

TEST_F(EncodeStageTest, TheFirstFrameIsAKeyAndEveryOtherLeansOnTheOneBefore) {
  EXPECT_TRUE(encoded(job(GazePhase::Fixation)).is_key);
  for (int i = 0; i < 3; ++i) {
    const net::FrameBegin begin = encoded(job(GazePhase::Fixation));
    EXPECT_FALSE(begin.is_key);
    EXPECT_EQ(begin.reference_frame, begin.frame - 1);
  }
}

TEST_F(EncodeStageTest, AKeyFrameIsMadeForAClientThatLostOne) {
  encoded(job(GazePhase::Fixation));
  FrameJob wanted = job(GazePhase::Fixation);
  wanted.start.is_key_wanted = true;
  const net::FrameBegin begin = encoded(std::move(wanted));
  EXPECT_TRUE(begin.is_key);
  EXPECT_EQ(begin.reference_frame, 0U);
}

TEST_F(EncodeStageTest, ASaccadeMovesTheGridButForcesNoKeyFrame) {
  encoded(job(GazePhase::Fixation));
  EXPECT_FALSE(encoded(job(GazePhase::Saccade, 12.0)).is_key);
  EXPECT_FALSE(encoded(job(GazePhase::Fixation, 12.0)).is_key) << "landed";
}

TEST_F(EncodeStageTest, ASaccadeIsGivenFewerBytesAndItsLandingMoreAgain) {
  for (int i = 0; i < 4; ++i) encoded(job(GazePhase::Fixation));
  const std::size_t before = color_bytes_;
  encoded(job(GazePhase::Saccade));
  EXPECT_LT(10 * color_bytes_, 9 * before) << "6 quantiser steps coarser";
  const std::size_t during = color_bytes_;
  encoded(job(GazePhase::Fixation));
  EXPECT_GT(color_bytes_, during);
}

TEST_F(EncodeStageTest, ALinkThatLosesTooMuchGetsColourThatLeansOnNothing) {
  encoded(job(GazePhase::Fixation));
  FrameJob stateless = job(GazePhase::Fixation);
  stateless.start.quality.color = Quality::Color::Stateless;
  const net::FrameBegin begin = encoded(std::move(stateless));
  EXPECT_TRUE(begin.is_key);
  EXPECT_EQ(begin.slices[0].codec, net::SliceCodec::Jpeg);
  EXPECT_TRUE(encoded(job(GazePhase::Fixation)).is_key) << "nothing is left to lean on";
}

}  // namespace
}  // namespace macula::session
