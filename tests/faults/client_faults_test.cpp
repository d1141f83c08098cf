// Clients that vanish, flood, repeat themselves, talk nonsense, and clients that share a server.
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <thread>

#include "shared/net/wire.h"
#include "shared/net/zmq_socket.h"
#include "tests/faults/faults_fixture.h"

namespace macula::faults {
namespace {

/// A second client of another machine, with a key of its own that the server allows.
class SecondMachine {
 public:
  SecondMachine(const std::string& server_keys, const std::string& name) {
    const auto own = net::load_or_make_keys(keys_.path(), net::Role::Client);
    EXPECT_TRUE(own && net::allow_client(server_keys, name, own->public_z85));
    server_key_ = net::load_or_make_keys(server_keys, net::Role::Server)->public_z85;
  }
  std::unique_ptr<EndpointClient> viewer(const std::string& endpoint) const {
    return std::make_unique<EndpointClient>(endpoint, keys_.path(), server_key_);
  }

 private:
  TemporaryFolder keys_;
  std::string server_key_;
};

TEST(ClientFaults, OnesThatVanishLeaveNothing) {
  const TemporaryFolder keys;
  const ServerProcess server(keys.path());
  const auto visit = [&] {
    const auto viewer = viewer_of(server.endpoint(), keys.path());
    return viewer->step_until_frames(2);  // and gone, without a Bye
  };
  const auto settled = [&](int descriptors) {
    const auto start = Clock::now();
    while (server.size().descriptors > descriptors && Clock::now() - start < 20s)
      std::this_thread::sleep_for(20ms);
    return server.size();
  };
  const int warm_up = 5;
  for (int i = 0; i < warm_up; ++i) ASSERT_TRUE(visit());
  std::this_thread::sleep_for(3500ms);
  const soak::ProcessSize before = server.size();
  const int visits = times(15, 1000);
  for (int i = 0; i < visits; ++i) ASSERT_TRUE(visit());
  const soak::ProcessSize after = settled(before.descriptors);
  std::this_thread::sleep_for(3500ms);
  const double resident_mb = server.size().resident_mb;
  EXPECT_LE(after.descriptors, before.descriptors);
  EXPECT_LE(after.threads, before.threads);
#if !defined(__SANITIZE_ADDRESS__)
  EXPECT_LE(resident_mb, before.resident_mb * 1.01 + 4.0);  // a page of every arena, and 1 %
#endif
  note_fault("client vanishes", "descriptors and memory back to the start +-1 %",
             text(visits, " visits: ", before.descriptors, " -> ", after.descriptors,
                  " descriptors, ", before.resident_mb, " -> ", resident_mb, " MB"));
}

TEST(ClientFaults, AVanishedClientsSessionIsFreedWithinThreeSeconds) {
  const TemporaryFolder keys;
  LoopbackServer server(keys.path());
  const double freed_ms = least_of(3, 3100.0, [&] {
    auto viewer = viewer_of(server->endpoint(), keys.path());
    EXPECT_TRUE(viewer->step_until_frames(3));
    viewer.reset();
    const auto gone = Clock::now();
    while (!server->telemetry().now.empty() && Clock::now() - gone < 20s)
      std::this_thread::sleep_for(5ms);
    return ms_since(gone);
  });
  EXPECT_LE(freed_ms, 3100.0);  // 3 s after its last view, looked for every 10 ms
  note_fault("client vanishes", "session freed <= 3 s", text("after ", freed_ms, " ms"));
}

/// A client that is only a socket: it says as many views as it is told to, and acknowledges every
/// frame.
class Flooder {
 public:
  Flooder(const std::string& endpoint, const std::string& keys)
      : socket_(context_, net::SocketKind::Dealer) {
    const net::KeyPair own = *net::load_or_make_keys(keys, net::Role::Client);
    net::set_common_options(socket_, net::Limits{});
    socket_.set(ZMQ_IMMEDIATE, 0);
    socket_.set(ZMQ_SNDHWM, 10'000);
    socket_.set(ZMQ_CURVE_SERVERKEY, net::load_or_make_keys(keys, net::Role::Server)->public_z85);
    socket_.set(ZMQ_CURVE_PUBLICKEY, own.public_z85);
    socket_.set(ZMQ_CURVE_SECRETKEY, own.secret_z85);
    EXPECT_TRUE(socket_.connect(endpoint));
    net::Hello hello;
    hello.program = "flooder";
    hello.eyes = {{math::symmetric_fov(Degrees{90.0}, 1.0), 64, 64}};
    hello.codecs = {"jpeg"};
    say(hello);
  }
  /// Frames a second while it says `views` every millisecond.
  double frame_rate(int views, std::chrono::milliseconds span) {
    const std::uint64_t before = frames_;
    const auto begin = Clock::now();
    auto next = begin;
    while (Clock::now() - begin < span) {
      for (; next <= Clock::now(); next += 1ms) {
        for (int i = 0; i < views; ++i) say_view();
        hear();
      }
      std::this_thread::sleep_for(500us);
    }
    return 1e3 * static_cast<double>(frames_ - before) / ms_since(begin);
  }

 private:
  void say(const net::Message& message) {
    const std::string envelope = net::encode_envelope(message);
    socket_.send({envelope, nullptr, 0, 0});
  }
  void say_view() {
    net::ViewState view;
    view.sequence = ++sequence_;
    view.eyes.push_back({{}, math::symmetric_fov(Degrees{90.0}, 1.0), {}});
    view.acks = acks_;
    say(view);
  }
  void hear() {
    for (;;) {
      net::Incoming message;
      if (!socket_.receive(message)) return;
      const auto decoded = net::decode_envelope(message.parts[0].bytes());
      if (!decoded) continue;
      if (const auto* welcome = std::get_if<net::Welcome>(&*decoded)) acks_.epoch = welcome->epoch;
      if (const auto* end = std::get_if<net::FrameEnd>(&*decoded)) {
        acks_.received = end->frame;
        ++frames_;
      }
    }
  }

  net::Context context_;
  net::Socket socket_;
  net::Acks acks_;
  std::uint64_t sequence_ = 0, frames_ = 0;
};

/// Frames take 20 ms here, so that not the processors' load but the server's attention decides.
TEST(ClientFaults, AFloodOfPosesCostsNoFrames) {
  const TemporaryFolder keys;
  loopback::LoopbackServerOptions steady;
  steady.delays.render = 20ms;
  LoopbackServer server(keys.path(), steady);
  ASSERT_TRUE(net::load_or_make_keys(keys.path(), net::Role::Client));
  Flooder flooder(server->endpoint(), keys.path());
  flooder.frame_rate(1, 1000ms);
  double views_per_s = 0.0, calm = 0.0, flooded = 0.0;
  const double lost_share = least_of(4, 0.05, [&] {
    calm = flooder.frame_rate(1, 1500ms);
    const std::uint64_t before = server->telemetry().net.views;
    const auto begin = Clock::now();
    flooded = flooder.frame_rate(10, 1500ms);
    views_per_s =
        1e3 * static_cast<double>(server->telemetry().net.views - before) / ms_since(begin);
    return 1.0 - flooded / calm;
  });
  EXPECT_GT(calm, 10.0);
  EXPECT_LE(lost_share, 0.05);
  EXPECT_LE(server->telemetry().sessions.most_in_flight_excess, 0);
  note_fault("pose flood, 10 kHz said", "frame rate >= 95 % of normal (1 kHz), one view waits",
             text(views_per_s, " views/s taken: ", flooded, " of ", calm, " frames/s"));
}

/// A viewer that says what the test wants.
class Liar {
 public:
  Liar(LoopbackServer& server, const std::string& keys)
      : server_(server), viewer_(viewer_of(server->endpoint(), keys)) {
    EXPECT_TRUE(viewer_->step_until_frames(3));
  }
  /// Says it until the server has counted something new.
  void say(const std::function<void(net::ViewState&)>& spoil) {
    const std::uint64_t before = counted();
    const auto start = Clock::now();
    while (counted() == before && Clock::now() - start < 20s) {
      net::ViewState view = viewer_->next_view();
      spoil(view);
      viewer_->endpoint().publish(view);
      viewer_->take(1ms);
    }
  }
  std::uint64_t rejected() const { return server_->telemetry().net.rejected_views; }
  EndpointClient& viewer() { return *viewer_; }

 private:
  std::uint64_t counted() const {
    const auto net = server_->telemetry().net;
    return net.rejected_views + net.malformed + net.views;
  }
  LoopbackServer& server_;
  std::unique_ptr<EndpointClient> viewer_;
};

TEST(ClientFaults, PosesThatWereSaidBeforeAreNeverRendered) {
  const TemporaryFolder keys;
  LoopbackServer server(keys.path());
  Liar liar(server, keys.path());
  const std::uint64_t newest = liar.viewer().frames().back().begin.view_sequence;
  const std::uint64_t before = liar.rejected();
  const std::size_t frames_before = liar.viewer().frames().size();
  for (std::uint64_t i = 0; i < 30; ++i)
    liar.say([&](net::ViewState& view) { view.sequence = 1 + i % newest; });
  ASSERT_TRUE(liar.viewer().step_until_frames(frames_before + 3));
  int rendered = 0;
  const auto& frames = liar.viewer().frames();
  for (std::size_t i = 1; i < frames.size(); ++i)
    rendered += frames[i].begin.view_sequence <= frames[i - 1].begin.view_sequence ? 1 : 0;
  const std::uint64_t rejected = liar.rejected() - before;
  EXPECT_EQ(rendered, 0);
  EXPECT_GE(rejected, 30U);
  note_fault("stale and repeated poses", "0 rendered, counted",
             text(rendered, " rendered, ", rejected, " counted"));
}

TEST(ClientFaults, PosesThatAreNoPosesAreAllRejected) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::function<void(net::ViewState&)>> lies{
      [](auto& v) { v.stage_from_head.position.x = kNaN; },
      [](auto& v) { v.stage_from_head.position.y = std::numeric_limits<double>::infinity(); },
      [](auto& v) { v.stage_from_head.position.z = 1e30; },
      [](auto& v) { v.stage_from_head.rotation.w += 0.5; },
      [](auto& v) {
        v.stage_from_head.rotation = {0, 0, 0, 0};
      },
      [](auto& v) { v.stage_from_head.rotation.x = kNaN; },
      [](auto& v) { v.eyes[0].head_from_eye.position.x = kNaN; },
      [](auto& v) { v.eyes[1].fov = {}; },
      [](auto& v) { v.eyes[0].fov = math::symmetric_fov(Degrees{180.0}, 1.0); },
      [](auto& v) { std::swap(v.eyes[0].fov.left, v.eyes[0].fov.right); },
      [](auto& v) {
        v.eyes[1].gaze.direction = {0.0F, 0.0F, 0.0F};
      },
      [](auto& v) { v.eyes[1].gaze.direction.x = std::nanf(""); },
      [](auto& v) { v.eyes[1].gaze.confidence = 2.0F; },
      [](auto& v) { v.eyes.clear(); }};
  const TemporaryFolder keys;
  LoopbackServer server(keys.path());
  Liar liar(server, keys.path());
  const auto counted = [&] {
    const auto net = server->telemetry().net;
    return net.rejected_views + net.malformed;
  };
  int rejected = 0, said = 0;
  const int rounds = times(2, 50);
  for (int round = 0; round < rounds; ++round) {
    for (const auto& lie : lies) {
      const std::uint64_t before = counted();
      liar.say(lie);
      ++said;
      rejected += counted() > before ? 1 : 0;
    }
  }
  EXPECT_EQ(rejected, said);
  EXPECT_EQ(server->telemetry().non_finite_samples, 0U);
  const std::size_t before = liar.viewer().frames().size();
  EXPECT_TRUE(liar.viewer().step_until_frames(before + 3)) << "the last good pose's session stands";
  note_fault("NaN, 1e30, no rotation, no field of view", "100 % rejected, 0 NaN rendered",
             text(rejected, " of ", said, " rejected, ", server->telemetry().non_finite_samples,
                  " samples not finite"));
}

/// Two clients of a server that is busy all the time, each with a thread of its own.
class Sharing : public testing::Test {
 protected:
  Sharing() {
    loopback::LoopbackServerOptions busy;
    busy.delays.render = 20ms;
    server_ = std::make_unique<LoopbackServer>(keys_.path(), busy);
  }
  std::string endpoint() { return (*server_)->endpoint(); }

  TemporaryFolder keys_;
  SecondMachine other_{keys_.path(), "other"};
  std::unique_ptr<LoopbackServer> server_;
};

using Arrivals = std::vector<Clock::time_point>;

/// Steps on a thread of its own until told to stop; then it is known when its frames came.
class Watching {
 public:
  explicit Watching(std::unique_ptr<EndpointClient> viewer)
      : viewer_(std::move(viewer)), thread_([this](const std::stop_token& stop) {
          while (!stop.stop_requested()) viewer_->step(2ms);
        }) {}
  /// Gone as a killed process: no Bye.
  Arrivals vanish() {
    thread_.request_stop();
    thread_.join();
    Arrivals arrivals;
    for (const net::ReceivedFrame& frame : viewer_->frames())
      arrivals.emplace_back(
          std::chrono::duration_cast<Clock::duration>(frame.last_byte.time_since_epoch()));
    viewer_.reset();
    return arrivals;
  }

 private:
  std::unique_ptr<EndpointClient> viewer_;
  std::jthread thread_;
};

double count_between(const Arrivals& arrivals, Clock::time_point begin, Clock::time_point end) {
  return static_cast<double>(std::count_if(arrivals.begin(), arrivals.end(),
                                           [&](auto at) { return at >= begin && at < end; }));
}
/// Gaps that end in [begin, end), ms.
std::vector<double> gaps_between(const Arrivals& arrivals, Clock::time_point begin,
                                 Clock::time_point end) {
  std::vector<double> gaps;
  for (std::size_t i = 1; i < arrivals.size(); ++i)
    if (arrivals[i] >= begin && arrivals[i] < end)
      gaps.push_back(
          std::chrono::duration<double, std::milli>(arrivals[i] - arrivals[i - 1]).count());
  return gaps;
}

struct Shared {
  double alone = 0.0;                           ///< frames of one client
  double least_share = 0.0, other_share = 0.0;  ///< of them, with another
  double usual_gap_ms = 0.0, gap_at_death_ms = 0.0;
};

TEST_F(Sharing, EachOfTwoGetsNearlyHalfAndOnesDeathDelaysTheOtherByOneFrameAtMost) {
  constexpr double kFrame_ms = 20.0;
  const auto span = times(1, 4) * 2000ms;
  Shared found;
  const double excess = least_of(4, 0.0, [&] {
    Watching first(viewer_of(endpoint(), keys_.path()));
    std::this_thread::sleep_for(700ms);
    const auto begin = Clock::now();
    std::this_thread::sleep_for(span);
    Watching second(other_.viewer(endpoint()));
    std::this_thread::sleep_for(700ms);
    const auto shared = Clock::now();
    std::this_thread::sleep_for(span);
    const auto death = Clock::now();
    const Arrivals of_second = second.vanish();
    std::this_thread::sleep_for(500ms);
    const Arrivals of_first = first.vanish();
    found.alone = count_between(of_first, begin, begin + span);
    found.least_share = count_between(of_first, shared, shared + span) / found.alone;
    found.other_share = count_between(of_second, shared, shared + span) / found.alone;
    if (found.least_share > found.other_share) std::swap(found.least_share, found.other_share);
    found.usual_gap_ms = quantile(gaps_between(of_first, shared, death), 0.95);
    found.gap_at_death_ms = quantile(gaps_between(of_first, death, death + 300ms), 1.0);
    return std::max(
        {0.0, 0.45 - found.least_share, found.gap_at_death_ms - found.usual_gap_ms - kFrame_ms});
  });
  EXPECT_LE(excess, 0.0);
  note_fault("two clients", "each >= 45 % of one client's frames",
             text(1e2 * found.least_share, " % and ", 1e2 * found.other_share, " % of ",
                  found.alone, " frames"));
  note_fault("one of two clients killed", "the other late by at most one frame (20 ms)",
             text("longest gap then ", found.gap_at_death_ms, " ms, p95 before ",
                  found.usual_gap_ms, " ms"));
}

}  // namespace
}  // namespace macula::faults
