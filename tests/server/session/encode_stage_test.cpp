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

/// Grey, by up to half of `noise` brighter or darker, as the cell's place and the frame say.
Rgb noisy_grey(int x, int y, std::uint64_t frame, float noise) {
  const auto bits = math::hash_combine(math::hash_combine(frame, x), y) % 256;
  return Rgb{0.4F + noise * (static_cast<float>(bits) / 256.0F - 0.5F)};
}

/// A first layer of noise before a second one in every cell of the columns [0, columns), with as
/// much as `noise`.
FrameJob with_hidden(FrameJob job, int columns, float noise) {
  for (std::size_t eye = 0; eye < job.views.size(); ++eye) {
    disocclusion::HiddenLayer layer;
    image::Plane<Rgb>& seen = job.buffers.views[eye].radiance;
    layer.band.resize(seen.width(), seen.height());
    layer.radiance.resize(seen.width(), seen.height());
    layer.depth_m.resize(seen.width(), seen.height(), 4.0F);
    for (int y = 0; y < seen.height(); ++y) {
      for (int x = 0; x < seen.width(); ++x) {
        seen(x, y) = noisy_grey(x, y, job.start.key.frame, 0.4F);
        layer.radiance(x, y) = noisy_grey(x, y, job.start.key.frame, noise);
        layer.band(x, y) = x < columns ? 1 : 0;
      }
    }
    layer.cells = static_cast<std::size_t>(columns) * seen.height();
    job.hidden.push_back(std::move(layer));
  }
  job.start.view_cell_m = 0.05;
  return job;
}

std::size_t bytes_of_layer(const net::FrameBegin& begin, std::uint32_t layer) {
  std::size_t bytes = 0;
  for (const net::SliceEntry& slice : begin.slices) {
    if (slice.layer == layer) bytes += slice.size_bytes;
  }
  return bytes;
}

TEST_F(EncodeStageTest, TheSecondLayerFollowsTheFirstOfItsEye) {
  setup_.settings.color_codec = "jpeg";
  for (int i = 0; i < 12; ++i) encoded(with_hidden(job(GazePhase::Fixation), 0, 0.0F));
  const net::FrameBegin begin = encoded(with_hidden(job(GazePhase::Fixation), 8, 0.0F));
  ASSERT_EQ(begin.slices.size(), 10U);
  EXPECT_EQ(begin.view_cell_m, 0.05);
  for (std::size_t i = 0; i < begin.slices.size(); ++i) {
    EXPECT_EQ(begin.slices[i].eye, i / 5);
    EXPECT_EQ(begin.slices[i].layer, i % 5 < 2 ? 0U : 1U);
  }
  EXPECT_EQ(begin.slices[2].codec, net::SliceCodec::BandMask);
  EXPECT_EQ(begin.slices[3].codec, net::SliceCodec::Jpeg);
  EXPECT_GT(begin.views[0].hidden_depth_inverse_scale_per_m, 0.0F);
  EXPECT_EQ(encoded(job(GazePhase::Fixation)).slices.size(), 4U);
}

TEST_F(EncodeStageTest, TheSecondLayerTakesAQuarterOfTheBytesAtMost) {
  setup_.settings.color_codec = "jpeg";
  std::size_t hidden = 0, seen = 0, whole = 0;
  for (int i = 0; i < 12; ++i) {
    FrameJob made = with_hidden(job(GazePhase::Fixation), 64, 0.4F);
    whole += made.hidden[0].cells + made.hidden[1].cells;
    const auto frame = stage_.encode(made);
    ASSERT_TRUE(frame);
    if (i >= 4) {  // before, too little has been sent for it to have a share of
      EXPECT_GT(frame->end.hidden_cells, 0U) << "part of it stays";
    }
    hidden += bytes_of_layer(frame->begin, 1);
    seen += bytes_of_layer(frame->begin, 0);
    whole -= frame->end.hidden_cells;
  }
  EXPECT_GT(whole, 0U) << "and part of it gave way";
  EXPECT_LE(3 * hidden, seen);
}

TEST_F(EncodeStageTest, ASmallSecondLayerComesWhole) {
  setup_.settings.color_codec = "jpeg";
  for (int i = 0; i < 12; ++i) encoded(with_hidden(job(GazePhase::Fixation), 0, 0.0F));
  FrameJob made = with_hidden(job(GazePhase::Fixation), 3, 0.0F);
  const std::size_t cells = made.hidden[0].cells + made.hidden[1].cells;
  const auto frame = stage_.encode(made);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->end.hidden_cells, cells);
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
