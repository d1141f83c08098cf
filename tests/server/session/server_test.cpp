// The server's threads against a network and a kernel that do what a test says.
#include "server/session/server.h"

#include <gtest/gtest.h>
#include <chrono>
#include <functional>
#include <thread>

#include "server/kernels/scene_timeline.h"
#include "server/scene/load.h"
#include "tests/server/session/session_fixtures.h"

namespace macula::session {
namespace {

using namespace std::chrono_literals;
constexpr net::PeerId kPeer{1};

/// What the server sent, and what it will hear; shared between the test and the endpoint.
struct Wire {
  base::Channel<net::ServerEvent> events{1024};
  std::mutex mutex;
  std::vector<net::Message> messages;
  std::vector<net::EncodedFrame> frames;

  template <class Kind>
  std::vector<Kind> sent() {
    std::lock_guard lock(mutex);
    std::vector<Kind> found;
    for (const net::Message& message : messages)
      if (const auto* specific = std::get_if<Kind>(&message)) found.push_back(*specific);
    return found;
  }
  std::vector<net::EncodedFrame> frames_so_far() {
    std::lock_guard lock(mutex);
    return frames;
  }
};

class ScriptedEndpoint final : public net::ServerEndpoint {
 public:
  ScriptedEndpoint(std::shared_ptr<Wire> wire, const base::Clock& clock)
      : wire_(std::move(wire)), clock_(clock) {}
  std::string endpoint() const override { return "tcp://127.0.0.1:1"; }
  std::string public_key_z85() const override { return "key"; }
  std::optional<net::ServerEvent> wait(Nanoseconds timeout) override {
    return wire_->events.wait(timeout);
  }
  void send(net::PeerId, net::Message message) override {
    std::lock_guard lock(wire_->mutex);
    wire_->messages.push_back(std::move(message));
  }
  void send_frame(net::PeerId peer, net::EncodedFrame frame) override {
    const ServerTime now{clock_.now()};
    (void)wire_->events.put(
        net::FrameSent{peer, frame.begin.epoch, frame.begin.frame, now, now, false});
    std::lock_guard lock(wire_->mutex);
    wire_->frames.push_back(std::move(frame));
  }
  net::ServerCounters counters() const override { return {}; }

 private:
  std::shared_ptr<Wire> wire_;
  const base::Clock& clock_;
};

/// Grey walls two meters away; `tiles` pieces of work of `tile_time` each before they are done.
class WallKernel final : public kernels::Kernel {
 public:
  WallKernel(std::size_t tiles, Nanoseconds tile_time) : tiles_(tiles), tile_time_(tile_time) {}
  kernels::FrameReport render(const kernels::FrameRequest& request, const kernels::SceneFrame&,
                              kernels::History&, scheduling::TileScheduler& scheduler,
                              kernels::FrameBuffers& out) const override {
    kernels::FrameReport report;
    const auto outcome =
        scheduler.run(tiles_, [&](std::size_t) { std::this_thread::sleep_for(tile_time_); });
    report.stopped = outcome == scheduling::Outcome::Stopped;
    out.views.resize(request.views.size());
    for (std::size_t i = 0; i < out.views.size(); ++i) {
      const PixelGrid& grid = request.views[i].grid;
      out.views[i].radiance.resize(grid.width(), grid.height(), Rgb{0.5F});
      out.views[i].depth_m.resize(grid.width(), grid.height(), 2.0F);
      report.primary_rays += out.views[i].radiance.size();
    }
    return report;
  }
  void shade(std::span<const kernels::SurfacePoint>, const kernels::SceneFrame&,
             scheduling::TileScheduler&, std::span<Rgb> out) const override {
    std::fill(out.begin(), out.end(), Rgb{0.5F});
  }

 private:
  std::size_t tiles_;
  Nanoseconds tile_time_;
};

/// Waits for what must happen; the limit only ends a test that would hang.
bool eventually(const std::function<bool()>& happened) {
  for (int i = 0; i < 20000; ++i) {
    if (happened()) return true;
    std::this_thread::sleep_for(1ms);
  }
  return false;
}

class ServerTest : public testing::Test {
 protected:
  void serve(const StageDelays& delays = {}, std::size_t tiles = 1, Nanoseconds tile_time = 1ms) {
    ServerConfig config;
    config.delays = delays;
    config.encode_threads = encode_threads_;
    config.description = "as the test says";
    auto scene = scene::load_scene("cornell");
    ASSERT_TRUE(scene) << scene.error().message();
    ServerParts parts;
    parts.scene = *kernels::SceneTimeline::create(*scene);
    parts.kernel = std::make_shared<WallKernel>(tiles, tile_time);
    parts.scheduler = std::make_shared<scheduling::TileScheduler>(2);
    parts.clock = &clock_;
    parts.random = test::counted_bits();
    parts.endpoint = std::make_unique<ScriptedEndpoint>(wire_, clock_);
    server_ = std::move(*Server::create(config, std::move(parts)));
    server_->start();
  }
  net::Welcome connect() {
    hear(net::HelloReceived{kPeer, "alice", test::hello(), now()});
    EXPECT_TRUE(eventually([&] { return !wire_->sent<net::Welcome>().empty(); }));
    return wire_->sent<net::Welcome>().back();
  }
  void hear(net::ServerEvent event) { ASSERT_TRUE(wire_->events.put(std::move(event))); }
  void look(const net::Acks& acks) {
    hear(net::ViewReceived{kPeer, test::view(++sequence_), acks, now()});
  }
  /// Looks around and acknowledges until `count` frames came.
  std::vector<net::EncodedFrame> stream(std::uint32_t epoch, std::size_t count) {
    EXPECT_TRUE(eventually([&] {
      const auto frames = wire_->frames_so_far();
      net::Acks acks;
      acks.epoch = epoch;
      acks.received = frames.empty() ? 0 : frames.back().begin.frame;
      look(acks);
      return frames.size() >= count;
    }));
    return wire_->frames_so_far();
  }
  ServerTime now() const { return ServerTime{clock_.now()}; }

  base::SteadyClock clock_;
  std::shared_ptr<Wire> wire_ = std::make_shared<Wire>();
  std::unique_ptr<Server> server_;
  std::uint64_t sequence_ = 0;
  int encode_threads_ = 1;
};

TEST_F(ServerTest, FramesCarryEverythingTheyWereMadeWith) {
  serve();
  const net::Welcome welcome = connect();
  const auto frames = stream(welcome.epoch, 3);
  const net::FrameBegin& begin = frames[1].begin;
  EXPECT_EQ(begin.epoch, welcome.epoch);
  EXPECT_EQ(begin.frame, 2U);
  EXPECT_GT(begin.view_sequence, frames[0].begin.view_sequence);
  EXPECT_EQ(begin.kernel, "ray");
  EXPECT_EQ(begin.config, "as the test says");
  ASSERT_EQ(begin.views.size(), 2U);
  ASSERT_EQ(begin.slices.size(), 4U);
  for (std::size_t i = 0; i < begin.slices.size(); ++i) {
    EXPECT_EQ(begin.slices[i].size_bytes, frames[1].payloads[i]->size());
    const PixelGrid& grid = begin.views[begin.slices[i].eye].grid;
    EXPECT_EQ(begin.slices[i].rect, (image::Rect{0, 0, grid.width(), grid.height()}));
  }
}

TEST_F(ServerTest, FramesTellTheSceneTimeOfTheirBeginning) {
  serve();
  const ServerTime started = now();
  const auto frames = stream(connect().epoch, 4);
  Nanoseconds last{0};
  for (const net::EncodedFrame& frame : frames) {
    const Nanoseconds scene_time = frame.begin.scene_time;
    EXPECT_EQ(scene_time % SceneClock::kTick, 0ns);
    EXPECT_GE(scene_time, last);
    // The clock began with the server, a moment before `started`.
    EXPECT_GE(scene_time, frame.end.render_begin - started - SceneClock::kTick);
    last = scene_time;
  }
}

TEST_F(ServerTest, StagesAreIntervalsWithoutAGap) {
  serve();
  const net::Welcome welcome = connect();
  const auto frames = stream(welcome.epoch, 6);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const net::FrameEnd& end = frames[i].end;
    EXPECT_LE(end.view_received, end.render_begin);
    EXPECT_LE(end.render_begin, end.render_end);
    EXPECT_EQ(end.render_end, end.encode_begin);
    EXPECT_LE(end.encode_begin, end.encode_end);
  }
}

TEST_F(ServerTest, AnInjectedDelayLandsInItsOwnStage) {
  serve({.view_wait = 30ms, .render = 0ms, .encode = 0ms});
  const auto frames = stream(connect().epoch, 3);
  for (const net::EncodedFrame& frame : frames)
    EXPECT_GE(frame.end.render_begin - frame.end.view_received, 30ms);
}

TEST_F(ServerTest, RendersTheNextFrameWhileEncodingTheLast) {
  serve({.view_wait = 0ms, .render = 20ms, .encode = 20ms});
  const auto frames = stream(connect().epoch, 8);
  int overlaps = 0;
  for (std::size_t i = 1; i < frames.size(); ++i)
    overlaps += frames[i].end.render_begin < frames[i - 1].end.encode_end ? 1 : 0;
  EXPECT_GE(overlaps, 5);
}

TEST_F(ServerTest, EncodesAFrameFirstWhereTheNextOneWouldTakeItsCores) {
  encode_threads_ = 2;  // as many as the renderer has
  serve({.render = 10ms, .encode = 20ms});
  const auto frames = stream(connect().epoch, 6);
  ASSERT_GE(frames.size(), 6U);
  for (std::size_t i = 1; i < frames.size(); ++i) {
    EXPECT_GE(frames[i].end.render_begin, frames[i - 1].end.encode_end) << "frame " << i;
    EXPECT_GE(frames[i].end.view_received, frames[i - 1].end.render_begin) << "a newer view";
  }
}

TEST_F(ServerTest, AClientThatLeavesFreesTheRenderThreads) {
  serve({}, 1'000'000, 1ms);  // a frame that would take minutes
  connect();
  look({});
  ASSERT_TRUE(eventually([&] {
    const Telemetry telemetry = server_->telemetry();
    return telemetry.sessions.frames_started == 1;
  }));
  hear(net::ByeReceived{kPeer, {"gone", 0}});
  EXPECT_TRUE(eventually([&] { return server_->telemetry().frames_stopped == 1; }));
  EXPECT_TRUE(wire_->frames_so_far().empty());
}

TEST_F(ServerTest, StoppingInTheMiddleOfAFrameSaysByeAndEnds) {
  serve({}, 1'000'000, 1ms);
  connect();
  look({});
  ASSERT_TRUE(eventually([&] { return server_->telemetry().sessions.frames_started == 1; }));
  server_->stop();
  const auto byes = wire_->sent<net::Bye>();
  ASSERT_EQ(byes.size(), 1U);
  EXPECT_GT(byes[0].retry_after_ms, 0U);
}

TEST_F(ServerTest, KeepsFramesInFlightWithinTheWindowWhenNothingIsAcknowledged) {
  serve();
  const net::Welcome welcome = connect();
  net::Acks none;
  none.epoch = welcome.epoch;
  ASSERT_TRUE(eventually([&] {
    look(none);
    return server_->telemetry().now.at(0).unsent == 1 && wire_->frames_so_far().size() >= 2;
  }));
  for (int i = 0; i < 50; ++i) {
    look(none);
    std::this_thread::sleep_for(1ms);
  }
  EXPECT_EQ(wire_->frames_so_far().size(), 2U) << "least window, no round trip known";
}

}  // namespace
}  // namespace macula::session
