// A recording makes the frames that were streamed again, to the byte, on any number of threads; and
// H.264 frames survive a link that damages them without a broken picture.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "client/frames/decode.h"
#include "server/session/recording.h"
#include "tests/loopback/server_fixture.h"
#include "tests/support/chaos_proxy.h"

namespace macula::loopback {
namespace {

std::vector<std::uint64_t> digests_of(const std::vector<net::ReceivedFrame>& frames) {
  std::vector<std::uint64_t> digests;
  for (const net::ReceivedFrame& frame : frames) {
    digests.push_back(session::digest(frame.begin.slices, [&](std::size_t i) {
      return std::span<const std::byte>(frame.payloads[i]);
    }));
  }
  return digests;
}

std::vector<std::uint64_t> replayed(const session::Recording& recording, int threads,
                                    const std::string& scene = "cornell") {
  std::vector<std::uint64_t> digests;
  const auto done = session::replay(
      recording, LoopbackServer::make_config(), LoopbackServer::shared_scene(scene),
      LoopbackServer::make_kernel(), threads,
      [&](const session::ReplayedFrame& frame) { digests.push_back(frame.digest); });
  EXPECT_TRUE(done) << done.error().message();
  return digests;
}

TEST(Replay, AHundredStreamedFramesComeOutAgainOnOneAndOnTwoThreads) {
  const TemporaryFolder keys;
  const std::string file = keys.path() + "/stream.rec";
  std::vector<net::ReceivedFrame> frames;
  {
    LoopbackServerOptions options;
    options.record = file;
    LoopbackServer server(keys.path(), options);
    EndpointClient viewer(server->endpoint(), keys.path(), server->public_key_z85());
    ASSERT_TRUE(viewer.step_until_frames(100));
    frames = viewer.frames();
  }
  const auto recording = session::load_recording(file);
  ASSERT_TRUE(recording) << recording.error().message();
  ASSERT_GE(recording->frames.size(), 100U);
  const auto once = replayed(*recording, 1), twice = replayed(*recording, 2);
  EXPECT_EQ(once, twice);
  // A key frame may have replaced others before the test took them: compare by frame.
  const auto streamed = digests_of(frames);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(once.at(frames[i].begin.frame - 1), streamed[i]) << "frame " << frames[i].begin.frame;
  }
}

TEST(Replay, SoDoTheirSecondLayers) {
  const TemporaryFolder keys;
  const std::string file = keys.path() + "/stream.rec";
  std::vector<net::ReceivedFrame> frames;
  {
    LoopbackServerOptions options;
    options.record = file;
    options.scene = "posts";
    options.longest_horizon = 100ms;
    options.most_view_cell_m = 0.2;  // of which a head at rest is given a fifth
    LoopbackServer server(keys.path(), options);
    EndpointClient viewer(server->endpoint(), keys.path(), server->public_key_z85(), 256);
    ASSERT_TRUE(viewer.step_until_frames(12));
    frames = viewer.frames();
  }
  EXPECT_TRUE(std::ranges::any_of(frames, [](const net::ReceivedFrame& frame) {
    return frame.begin.view_cell_m > 0.0 && frame.begin.slices.back().layer == 1;
  }));
  const auto recording = session::load_recording(file);
  ASSERT_TRUE(recording) << recording.error().message();
  const auto once = replayed(*recording, 1, "posts");
  EXPECT_EQ(once, replayed(*recording, 2, "posts"));
  const auto streamed = digests_of(frames);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(once.at(frames[i].begin.frame - 1), streamed[i]) << "frame " << frames[i].begin.frame;
  }
}

// The must-fail twin: another gaze, other bytes.
TEST(Replay, AFrameSeenFromElsewhereHasOtherBytes) {
  const TemporaryFolder keys;
  const std::string file = keys.path() + "/stream.rec";
  {
    LoopbackServerOptions options;
    options.record = file;
    LoopbackServer server(keys.path(), options);
    EndpointClient viewer(server->endpoint(), keys.path(), server->public_key_z85());
    ASSERT_TRUE(viewer.step_until_frames(3));
  }
  auto recording = *session::load_recording(file);
  recording.frames.resize(1);
  const auto before = replayed(recording, 1);
  recording.frames[0].start.view.stage_from_head.position.x += 0.05;
  EXPECT_NE(replayed(recording, 1), before);
}

TEST(Replay, WhatIsNoRecordingIsRefusedByName) {
  const TemporaryFolder folder;
  const std::string file = folder.path() + "/not.rec";
  std::ofstream(file) << "t_s,px\n";
  const auto refused = session::load_recording(file);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message().find("not.rec"), std::string::npos);
}

TEST(Replay, ADamagedFrameIsNamedAndACutOffEndIsLeftOut) {
  const TemporaryFolder keys;
  const std::string file = keys.path() + "/stream.rec";
  {
    LoopbackServerOptions options;
    options.record = file;
    LoopbackServer server(keys.path(), options);
    EndpointClient viewer(server->endpoint(), keys.path(), server->public_key_z85());
    ASSERT_TRUE(viewer.step_until_frames(5));
  }
  const std::size_t frames = session::load_recording(file)->frames.size();
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 7);
  EXPECT_EQ(session::load_recording(file)->frames.size(), frames - 1);
  std::fstream damaged(file, std::ios::in | std::ios::out | std::ios::binary);
  damaged.seekp(19 + 4 + 13 + 4 + 20);  // header, description, the first frame's length and ids
  damaged.write("\xff\xff\xff\xff", 4);
  damaged.close();
  const auto refused = session::load_recording(file);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message().find("frame 1"), std::string::npos);
}

// Bits flip now and then; each ends the connection or a frame. What is decoded is whole, and never
// leans on what was lost.
TEST(H264Stream, OverALinkThatDamagesBytesPicturesAreWholeOrAbsent) {
  if (!codec::can_encode_h264() || !codec::can_decode_h264()) GTEST_SKIP() << "no H.264";
  const TemporaryFolder keys;
  LoopbackServer server(keys.path());
  auto proxy = support::ChaosProxy::create(server->endpoint(), 5);
  ASSERT_TRUE(proxy);
  EndpointClient viewer((*proxy)->endpoint(), keys.path(), server->public_key_z85());
  const base::SteadyClock clock;
  frames::FrameDecoder decoder(clock);
  std::size_t taken = 0, decoded = 0, damaged = 0;
  ASSERT_TRUE(viewer.step_until([&] {
    for (; taken < viewer.frames().size(); ++taken) {
      EXPECT_EQ(viewer.frames()[taken].begin.slices[0].codec, net::SliceCodec::H264);
      if (decoder.decode(viewer.frames()[taken])) {
        ++decoded;
      } else {
        viewer.endpoint().request_key();
      }
      if (taken % 25 == 12 && damaged < 4) {
        (*proxy)->flip_bit_after(support::Direction::ToClient, 1000 + 777 * damaged);
        ++damaged;
      }
    }
    return decoded >= 130;
  }));
  EXPECT_GE((*proxy)->bits_flipped(), 3U);
  EXPECT_GT(
      viewer.endpoint().counters().socket_remakes + viewer.endpoint().counters().frames_incomplete,
      0U);
}

}  // namespace
}  // namespace macula::loopback
