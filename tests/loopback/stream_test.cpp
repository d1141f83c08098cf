// The whole way: a real server, real sockets, the real client. What is shown is in order, every
// frame's stages add up to its age, and time spent in a stage is found in that stage.
#include <gtest/gtest.h>

#include <cmath>

#include "client/app/run_client.h"
#include "client/app/warp_stage.h"
#include "shared/base/text.h"
#include "tests/loopback/server_fixture.h"
#include "tests/support/chaos_proxy.h"
#include "tests/support/handed_data.h"

namespace macula::loopback {
namespace {

using frames::Stage;

/// Delays of one run, wherever they belong.
struct Delays {
  LoopbackServerOptions server;
  client_app::StageDelays client;
  net::ClientDelays wire;
  Nanoseconds link_up{0}, link_down{0};  ///< of the way between, both 0: there is none
};

Delays delays_in(Stage stage, Nanoseconds delay) {
  Delays delays;
  switch (stage) {
    case Stage::Uplink:
      delays.wire.uplink = delay;
      break;
    case Stage::ViewWait:
      delays.server.delays.view_wait = delay;
      break;
    case Stage::Render:
      delays.server.delays.render = delay;
      break;
    case Stage::Encode:
      delays.server.delays.encode = delay;
      break;
    case Stage::SendQueue:
      delays.server.wire_delays.send_queue = delay;
      break;
    case Stage::Downlink:
      delays.server.wire_delays.downlink = delay;
      break;
    case Stage::Decode:
      delays.client.decode = delay;
      break;
    case Stage::Reproject:
      delays.client.reproject = delay;
      break;
    case Stage::PresentWait:
      delays.client.present = delay;
      break;
  }
  return delays;
}

client_app::ClientConfig small_viewer() {
  client_app::ClientConfig config;
  config.display = client_app::DisplayKind::Headless;
  config.width_px = config.height_px = 64;
  config.vertical_fov = Degrees{90.0};
  config.silence_patience = 60s;
  config.connect_patience = 60s;
  return config;
}

class Stream : public testing::Test {
 protected:
  display::ClientReport run(client_app::ClientConfig config, const Delays& delays = {}) {
    LoopbackServer server(keys_.path(), delays.server);
    net::ClientEndpointOptions options;
    const auto link = make_link(server->endpoint(), delays);
    options.connect = link ? link->endpoint() : server->endpoint();
    options.key_folder = keys_.path();
    options.server_key_z85 = server->public_key_z85();
    options.hello = make_hello(config, eye_rig(config), config.refresh_hz);
    options.delays = delays.wire;
    auto endpoint = net::ClientEndpoint::create(options, clock_);
    config.connect = server->endpoint();
    config.delays = delays.client;
    const std::atomic<bool> stop{false};
    auto report = run_client(config, **endpoint, clock_, stop);
    if (!report) {
      ADD_FAILURE() << report.error().message();
      return {};
    }
    EXPECT_LE(server->telemetry().sessions.most_in_flight_excess, 0);
    return std::move(*report);
  }

  static std::unique_ptr<support::ChaosProxy> make_link(const std::string& server,
                                                        const Delays& delays) {
    if (delays.link_up == 0ns && delays.link_down == 0ns) return nullptr;
    auto link = support::ChaosProxy::create(server);
    if (!link) {
      ADD_FAILURE() << link.error().message();
      return nullptr;
    }
    (*link)->shape(support::Direction::ToServer, {.delay = delays.link_up});
    (*link)->shape(support::Direction::ToClient, {.delay = delays.link_down});
    return std::move(*link);
  }

  TemporaryFolder keys_;
  const base::SteadyClock clock_;
};

/// Stages other than uplink and downlink are differences of one clock's stamps, so `unattributed`
/// is all that can keep the sum from the total.
void expect_stages_add_up(const display::ClientReport& report) {
  for (const auto& account : report.accounts) {
    EXPECT_LE(std::chrono::abs(account.times.total - account.times.sum()), units::from_ms(0.2))
        << "frame " << account.id.frame;
  }
}

/// A viewer that moves past what posts hide.
client_app::ClientConfig moving_viewer() {
  client_app::ClientConfig config = small_viewer();
  config.width_px = config.height_px = 256;
  config.settings.color_codec = "jpeg";
  config.frames = 100;
  return config;
}

/// A server on the way to which frames take 60 ms, so that they are shown from elsewhere.
Delays far_server(double view_cell_m) {
  Delays delays;
  delays.server.scene = "posts";
  delays.server.longest_horizon = 100ms;
  delays.server.most_view_cell_m = view_cell_m;
  delays.server.delays.render = 60ms;
  return delays;
}

TEST_F(Stream, BringsWhatNearSurfacesHideToAClientThatCanDrawIt) {
  const auto report = run(moving_viewer(), far_server(0.1));
  EXPECT_EQ(report.ended, display::RunEnd::FramesShown);
  EXPECT_EQ(report.frames_undecodable, 0U);
  EXPECT_GT(report.hidden_cells.largest(), 10.0);
  EXPECT_GT(report.hidden_bytes.mean(), 0.0);
  EXPECT_LE(report.hidden_bytes.mean(), 0.25 * report.frame_bytes.mean());
}

// A frame as it came, shown five centimeters from where it was rendered.
TEST_F(Stream, WhatNearSurfacesHideFillsWhatAMoveUncovers) {
  LoopbackServerOptions options = far_server(0.3).server;  // a head at rest is given a fifth
  LoopbackServer server(keys_.path(), options);
  EndpointClient viewer(server->endpoint(), keys_.path(), server->public_key_z85(), 256, "jpeg");
  ASSERT_TRUE(viewer.step_until_frames(20));  // by then it has the bytes it may have
  frames::FrameDecoder decoder(clock_);
  Result<frames::DecodedFrame> frame = base::bad_input("none came");
  for (const net::ReceivedFrame& received : viewer.frames()) frame = decoder.decode(received);
  ASSERT_TRUE(frame) << frame.error().message();
  const auto guessed = [&](reprojection::WarpOptions::Layers layers) {
    client_app::WarpStage stage({.layers = layers}, client_app::WarpStage::Depth::Leave);
    Pose head = frame->begin.views[0].stage_from_view;
    head.position.x += 0.05;
    return stage.warp(*frame, head, eye_rig(moving_viewer())).front().filled_px;
  };
  EXPECT_GT(guessed(reprojection::WarpOptions::Layers::First), 100U);
  EXPECT_LT(4 * guessed(reprojection::WarpOptions::Layers::Both),
            guessed(reprojection::WarpOptions::Layers::First));
}

// The twin: a client that only turns frames says so, and gets none.
TEST_F(Stream, BringsNothingHiddenToAClientThatOnlyTurns) {
  client_app::ClientConfig config = moving_viewer();
  config.warp = client_app::ClientConfig::Warp::Rotation;
  EXPECT_EQ(run(config, far_server(0.1)).hidden_cells.largest(), 0.0);
}

TEST_F(Stream, BoundsHowFarOffAnythingIsShown) {
  const auto report = run(moving_viewer(), far_server(0.1));
  EXPECT_EQ(report.bound_p95_px.count(), report.distinct_server_frames);
  EXPECT_GT(report.bound_p95_px.quantile(0.5), 0.5) << "half a pixel is what cells alone take";
  // How late a busy machine shows its pictures is in it: some pixels, under sanitizers dozens.
  EXPECT_LT(report.bound_p95_px.quantile(0.5), 0.5 * moving_viewer().width_px);
}

TEST_F(Stream, ShowsThreeHundredRefreshesOfARecordedTraceInOrder) {
  MACULA_NEEDS_HANDED_DATA("traces/eyenavgs_u111_train.csv");
  client_app::ClientConfig config = small_viewer();
  config.trace_file = (test::handed_data() / "traces/eyenavgs_u111_train.csv").string();
  config.frames = 300;
  const auto report = run(config);
  EXPECT_EQ(report.ended, display::RunEnd::FramesShown);
  EXPECT_EQ(report.shown_frames, 300U);
  EXPECT_EQ(report.frames_out_of_order, 0U);
  EXPECT_EQ(report.frames_undecodable, 0U);
  EXPECT_GE(report.distinct_server_frames, 20U);
  EXPECT_GE(report.accounts.size(), 10U);
  expect_stages_add_up(report);
}

TEST_F(Stream, ShowsANewFrameEveryRefreshWhenAsFastAsPossible) {
  client_app::ClientConfig config = small_viewer();
  config.pacing = client_app::Pacing::AsFastAsPossible;
  config.frames = 60;
  const auto report = run(config);
  EXPECT_EQ(report.shown_frames, 60U);
  EXPECT_EQ(report.distinct_server_frames, 60U);
  EXPECT_EQ(report.frames_out_of_order, 0U);
  expect_stages_add_up(report);
}

using StageCosts = std::array<double, frames::kStageCount>;

// Contention only ever adds time, so a low quantile of the frames is what a stage costs by itself.
StageCosts own_cost_ms(const display::ClientReport& report) {
  StageCosts cost{};
  for (std::size_t i = 0; i < cost.size(); ++i) {
    cost[i] = report.stage_ms(static_cast<Stage>(i)).quantile(0.1);
  }
  return cost;
}

/// The first stage whose cost did not change by what was spent in it, +-1 ms; empty where all did.
std::string first_wrong_stage(const StageCosts& plain, const StageCosts& cost, std::size_t spent) {
  for (std::size_t seen = 0; seen < cost.size(); ++seen) {
    const double change_ms = cost[seen] - plain[seen], expected_ms = seen == spent ? 30.0 : 0.0;
    if (std::abs(change_ms - expected_ms) <= 1.0) continue;
    return base::concat("spent in ", name(static_cast<Stage>(spent)), ", ",
                        name(static_cast<Stage>(seen)), " changed by ", change_ms, " ms");
  }
  return {};
}

TEST_F(Stream, FindsThirtyMillisecondsInTheStageTheyWereSpentInAndInNoOther) {
  client_app::ClientConfig config = small_viewer();
  config.pacing = client_app::Pacing::AsFastAsPossible;
  config.frames = 40;
  // Little work in every stage, so that a busy machine has little to stretch.
  config.eyes = 1;
  config.width_px = config.height_px = 32;
  // A thread that slept wakes up cold. All runs let everything sleep once a refresh, so that the
  // delay under test is all that differs.
  const auto costs_with = [&](Delays delays) {
    delays.client.idle = units::from_ms(30.0);
    const auto report = run(config, delays);
    expect_stages_add_up(report);
    return own_cost_ms(report);
  };
  // A neighbour that wakes up between the two runs of a pair changes every stage: such a pair is
  // measured again, both halves. A stage that attributes time wrongly is wrong in every pair.
  constexpr int kPairs = 4;
  for (std::size_t spent = 0; spent < frames::kStageCount; ++spent) {
    std::string wrong = "never measured";
    for (int pair = 0; pair < kPairs && !wrong.empty(); ++pair) {
      const StageCosts plain = costs_with({});
      wrong = first_wrong_stage(
          plain, costs_with(delays_in(static_cast<Stage>(spent), units::from_ms(30.0))), spent);
    }
    EXPECT_EQ(wrong, "");
  }
}

/// The first stage whose cost did not change by what the link adds to it, +-1 ms.
std::string first_stage_moved_by_the_link(const StageCosts& plain, const StageCosts& cost,
                                          double one_way_ms) {
  for (std::size_t i = 0; i < cost.size(); ++i) {
    const auto stage = static_cast<Stage>(i);
    const bool is_link = stage == Stage::Uplink || stage == Stage::Downlink;
    const double off_ms = cost[i] - plain[i] - (is_link ? one_way_ms : 0.0);
    if (std::abs(off_ms) > 1.0) return base::concat(name(stage), " is off by ", off_ms, " ms");
  }
  return {};
}

// Both programs read one clock here, so the true offset is 0.
TEST_F(Stream, ALinkOfTenMillisecondsEachWayIsUplinkAndDownlinkAndNothingElse) {
  client_app::ClientConfig config = small_viewer();
  config.pacing = client_app::Pacing::AsFastAsPossible;
  config.frames = 40;
  config.eyes = 1;
  config.width_px = config.height_px = 32;
  Delays plain, linked;
  plain.client.idle = linked.client.idle = units::from_ms(30.0);
  linked.link_up = linked.link_down = units::from_ms(10.0);
  std::string wrong = "never measured";
  for (int pair = 0; pair < 4 && !wrong.empty(); ++pair) {
    const StageCosts without = own_cost_ms(run(config, plain));
    const auto report = run(config, linked);
    expect_stages_add_up(report);
    wrong = first_stage_moved_by_the_link(without, own_cost_ms(report), 10.0);
    ASSERT_TRUE(report.clock);
    const Nanoseconds error = std::chrono::abs(report.clock->server_minus_client);
    EXPECT_LE(error, report.clock->bound);
    if (error > units::from_ms(0.5)) wrong = base::concat("clock off by ", units::to_ms(error));
  }
  EXPECT_EQ(wrong, "");
}

// No exchange can tell an asymmetric link from a clock that is off; the bound says so.
TEST_F(Stream, OnAnAsymmetricLinkTheClockIsOffByLessThanItsBound) {
  client_app::ClientConfig config = small_viewer();
  config.frames = 40;
  config.eyes = 1;
  config.width_px = config.height_px = 32;
  Delays delays;
  delays.link_up = units::from_ms(2.0);
  delays.link_down = units::from_ms(18.0);
  const auto report = run(config, delays);
  ASSERT_TRUE(report.clock);
  EXPECT_GE(std::chrono::abs(report.clock->server_minus_client), units::from_ms(4.0));
  EXPECT_LE(std::chrono::abs(report.clock->server_minus_client), report.clock->bound);
}

}  // namespace
}  // namespace macula::loopback
