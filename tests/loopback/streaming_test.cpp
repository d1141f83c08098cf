// A real server and real sockets: frames arrive complete, in order and within their window, and
// neither silence, a vanished client nor a restart stops the stream for good.
#include <gtest/gtest.h>

#include "tests/loopback/server_fixture.h"

namespace macula::loopback {
namespace {

class Streaming : public testing::Test {
 protected:
  EndpointClient client() { return {server_->endpoint(), keys_.path(), server_->public_key_z85()}; }
  bool eventually(const std::function<bool()>& happened) {
    for (int i = 0; i < 20000; ++i) {
      if (happened()) return true;
      std::this_thread::sleep_for(1ms);
    }
    return false;
  }

  TemporaryFolder keys_;
  LoopbackServer server_{keys_.path()};
};

TEST_F(Streaming, ThreeHundredFramesArriveInOrderWithinTheWindow) {
  EndpointClient viewer = client();
  ASSERT_TRUE(viewer.step_until_frames(300));
  const auto& frames = viewer.frames();
  for (std::size_t i = 1; i < frames.size(); ++i) {
    EXPECT_GT(frames[i].begin.frame, frames[i - 1].begin.frame);
    EXPECT_GT(frames[i].begin.view_sequence, frames[i - 1].begin.view_sequence);
    EXPECT_EQ(frames[i].begin.epoch, frames[0].begin.epoch);
  }
  const session::Telemetry telemetry = server_->telemetry();
  EXPECT_LE(telemetry.sessions.most_in_flight_excess, 0);
  EXPECT_LE(telemetry.sessions.most_in_flight, 6);
  EXPECT_EQ(telemetry.sessions.frames_lost, 0U);
  EXPECT_EQ(telemetry.sessions.acks_refused, 0U);
  EXPECT_EQ(telemetry.frames_failed, 0U);
}

TEST_F(Streaming, ServerStagesFollowEachOtherWithoutAGap) {
  EndpointClient viewer = client();
  ASSERT_TRUE(viewer.step_until_frames(30));
  for (const net::ReceivedFrame& frame : viewer.frames()) {
    EXPECT_LE(frame.end.view_received, frame.end.render_begin);
    EXPECT_LT(frame.end.render_begin, frame.end.render_end);
    EXPECT_EQ(frame.end.render_end, frame.end.encode_begin);
    EXPECT_LT(frame.end.encode_begin, frame.end.encode_end);
    EXPECT_GT(frame.end.rays, 0U);
  }
}

TEST_F(Streaming, AClientThatPausesIsServedAgainInTheSameSession) {
  EndpointClient viewer = client();
  ASSERT_TRUE(viewer.step_until_frames(5));
  for (int i = 0; i < 90; ++i) viewer.take(10ms);  // 0.9 s without a view
  const std::size_t before = viewer.frames().size();
  for (int i = 0; i < 10; ++i) viewer.take(10ms);
  EXPECT_EQ(viewer.frames().size(), before) << "nothing is rendered for a silent client";
  ASSERT_TRUE(viewer.step_until_frames(before + 5));
  EXPECT_EQ(viewer.frames().back().begin.epoch, viewer.frames().front().begin.epoch);
}

TEST_F(Streaming, AClientSilentForThreeSecondsIsFreedAndWelcomedAgain) {
  EndpointClient viewer = client();
  ASSERT_TRUE(viewer.step_until_frames(5));
  ASSERT_TRUE(eventually([&] {
    viewer.take(0ms);
    return server_->telemetry().now.empty();
  }));
  const std::uint32_t old_epoch = viewer.frames().back().begin.epoch;
  EXPECT_TRUE(viewer.step_until([&] { return viewer.frames().back().begin.epoch != old_epoch; }));
}

TEST_F(Streaming, AVanishedClientLeavesNothingBehind) {
  {
    EndpointClient viewer = client();
    ASSERT_TRUE(viewer.step_until_frames(5));
  }
  EXPECT_TRUE(eventually([&] { return server_->telemetry().now.empty(); }));
}

TEST_F(Streaming, TwoClientsShareTheRenderer) {
  const TemporaryFolder other_keys;
  const auto other = net::load_or_make_keys(other_keys.path(), net::Role::Client);
  ASSERT_TRUE(other);
  ASSERT_TRUE(net::allow_client(keys_.path(), "second", other->public_z85));
  EndpointClient first = client();
  EndpointClient second(server_->endpoint(), other_keys.path(), server_->public_key_z85());
  EXPECT_TRUE(first.step_until([&] {
    second.step(1ms);
    return first.frames().size() >= 40 && second.frames().size() >= 40;
  }));
  EXPECT_EQ(server_->telemetry().now.size(), 2U);
  EXPECT_LE(server_->telemetry().sessions.most_in_flight_excess, 0);
}

TEST_F(Streaming, AnUnknownClientKeyGetsNothing) {
  const TemporaryFolder stranger_keys;
  EndpointClient stranger(server_->endpoint(), stranger_keys.path(), server_->public_key_z85());
  for (int i = 0; i < 100; ++i) stranger.step(10ms);
  EXPECT_TRUE(stranger.frames().empty());
  EXPECT_TRUE(stranger.welcomes().empty());
  EXPECT_EQ(server_->telemetry().table.welcomed, 0U);
  EXPECT_GT(server_->telemetry().net.refused_handshakes, 0U);
}

TEST(Restart, AKilledServerThatComesBackIsUsedAgain) {
  const TemporaryFolder keys;
  auto server = std::make_unique<LoopbackServer>(keys.path());
  const std::string endpoint = (*server)->endpoint();
  EndpointClient viewer(endpoint, keys.path(), (*server)->public_key_z85());
  ASSERT_TRUE(viewer.step_until_frames(5));
  const std::uint32_t old_epoch = viewer.frames().back().begin.epoch;
  server.reset();
  for (int i = 0; i < 20; ++i) viewer.step(10ms);

  LoopbackServerOptions same_place;
  same_place.bind = endpoint;
  server = std::make_unique<LoopbackServer>(keys.path(), same_place);
  const auto up = std::chrono::steady_clock::now();
  ASSERT_TRUE(viewer.step_until([&] { return viewer.frames().back().begin.epoch != old_epoch; }));
  const auto took =
      std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now() - up);
  RecordProperty("recovery_ms", static_cast<int>(took.count()));
  std::printf("recovered %d ms after the server was up\n", static_cast<int>(took.count()));
  EXPECT_FALSE(viewer.welcomes().back().resumed) << "a new server knows no old session";
}

}  // namespace
}  // namespace macula::loopback
