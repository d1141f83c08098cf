#include <algorithm>
#include <optional>
#include <random>

#include "shared/base/text.h"
#include "tests/shared/net/net_fixture.h"
#include "tests/support/chaos_proxy.h"
#include "tests/support/fault_table.h"

namespace macula::net {
namespace {

using support::ChaosProxy;
using support::Direction;

/// A server that sends a new small frame whenever the newest is acknowledged, on a thread of its
/// own.
class BusyServer {
 public:
  explicit BusyServer(const std::string& keys, const std::string& bind = "tcp://127.0.0.1:*")
      : server_(keys, bind), thread_([this] { serve(); }) {}
  ~BusyServer() {
    stop_ = true;
    thread_.join();
  }
  std::string endpoint() { return server_.endpoint().endpoint(); }

 private:
  void serve() {
    while (!stop_) {
      const auto event = server_.endpoint().wait(10ms);
      if (!event) continue;
      if (const auto* const hello = std::get_if<HelloReceived>(&*event)) {
        server_.welcome(*hello);
        peer_ = hello->peer;
        frame_ = 0;
        send_next();
      }
      const auto* const view = std::get_if<ViewReceived>(&*event);
      if (view != nullptr && view->peer == peer_ && view->acks.epoch == server_.epoch() &&
          view->acks.received == frame_) {
        send_next();
      }
    }
  }
  void send_next() {
    std::this_thread::sleep_for(5ms);
    server_.endpoint().send_frame(peer_, make_frame(server_.epoch(), ++frame_, 20'000));
  }

  PlainServer server_;
  PeerId peer_;
  std::uint64_t frame_ = 0;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

/// The longest time without a new frame from `fault` to two seconds later; some damage (a reserved
/// flag) does no harm at all, so what counts is that frames come.
template <class Fault>
Nanoseconds longest_gap_after(ClientEndpoint& client, Fault&& fault) {
  EXPECT_TRUE(client.wait_frame(20s));
  fault();
  const auto start = std::chrono::steady_clock::now();
  auto newest = start;
  Nanoseconds longest{0};
  while (newest - start < 2s && longest < 20s) {
    const bool came = client.wait_frame(20s).has_value();
    const auto now = std::chrono::steady_clock::now();
    longest = std::max<Nanoseconds>(longest, now - newest);
    newest = now;
    if (!came) break;
  }
  return longest;
}

/// Shortest of several recoveries: a loaded machine may lengthen one, the requirement is the
/// wire's.
template <class Fault>
void expect_recovery_within_a_second(ClientEndpoint& client, Fault&& fault) {
  Nanoseconds shortest = 1h;
  for (int attempt = 0; attempt < 5 && shortest > 1s; ++attempt) {
    shortest = std::min(shortest, longest_gap_after(client, fault));
  }
  EXPECT_LE(shortest, 1s);
}

class Faults : public ::testing::TestWithParam<Direction> {};

// A flipped byte anywhere in a CURVE stream kills the connection one way or another: its box does
// not open, its length is nonsense, or nothing complete ever comes again.
TEST_P(Faults, OneFlippedByteIsRecoveredFromWithinASecond) {
  TemporaryFolder keys;
  BusyServer server(keys.path());
  auto proxy = ChaosProxy::create(server.endpoint(), 3);
  ASSERT_TRUE(proxy);
  const auto client = make_client(client_options((*proxy)->endpoint(), keys.path()));
  for (const std::uint64_t skip : {0U, 1U, 5U, 40U, 700U}) {
    expect_recovery_within_a_second(*client, [&] { (*proxy)->flip_bit_after(GetParam(), skip); });
  }
  EXPECT_GE((*proxy)->bits_flipped(), 5U);
  EXPECT_GE(client->counters().socket_remakes, 1U);
}

/// Every frame that comes is one the server sent, to the bit.
TEST(DamagedLink, BringsNoDamagedFrame) {
  TemporaryFolder keys;
  BusyServer server(keys.path());
  auto proxy = ChaosProxy::create(server.endpoint(), 3);
  ASSERT_TRUE(proxy);
  const auto client = make_client(client_options((*proxy)->endpoint(), keys.path()));
  std::mt19937_64 random(5);
  std::uint64_t frames = 0, damaged = 0;
  std::vector<double> waits_ms;
  const int flips = macula::test::times(8, 500);
  for (int i = 0; i < flips; ++i) {
    const bool to_client = i % 2 == 0;
    // Into the next frame or two; a client's messages are small.
    (*proxy)->flip_bit_after(to_client ? Direction::ToClient : Direction::ToServer,
                             random() % (to_client ? 40'000 : 400));
    const auto count = [&](const ReceivedFrame& frame) {
      ++frames;
      const auto sent = make_frame(frame.begin.epoch, frame.begin.frame, 20'000);
      damaged += frame.payloads.at(0) == *sent.payloads[0] ? 0 : 1;
    };
    const auto begin = std::chrono::steady_clock::now();
    auto newest = begin;
    Nanoseconds longest{0};
    while (newest - begin < 700ms) {
      const auto frame = client->wait_frame(20s);
      ASSERT_TRUE(frame);
      count(*frame);
      longest = std::max<Nanoseconds>(longest, std::chrono::steady_clock::now() - newest);
      newest = std::chrono::steady_clock::now();
    }
    waits_ms.push_back(units::to_ms(longest));
  }
  EXPECT_EQ(damaged, 0U);
  std::sort(waits_ms.begin(), waits_ms.end());
  EXPECT_LE(waits_ms[waits_ms.size() / 2], 1000.0);
  macula::test::note_fault(
      "flipped bits over sockets", "0 damaged frames in 500 (8 in every test run), <= 1 s",
      base::concat((*proxy)->bits_flipped(), " flips, ", frames, " frames, ", damaged,
                   " damaged; longest wait: median ", waits_ms[waits_ms.size() / 2], " ms, p95 ",
                   waits_ms[waits_ms.size() * 95 / 100], " ms"));
}

TEST_P(Faults, AStallIsNoticedAndRecoveredFrom) {
  TemporaryFolder keys;
  BusyServer server(keys.path());
  auto proxy = ChaosProxy::create(server.endpoint());
  ASSERT_TRUE(proxy);
  const auto client = make_client(client_options((*proxy)->endpoint(), keys.path()));
  ASSERT_TRUE(client->wait_frame(20s));
  (*proxy)->stall(Direction::ToClient);
  ASSERT_TRUE(next_event<Stale>(*client));
  (*proxy)->resume(Direction::ToClient);
  EXPECT_TRUE(next_event<Fresh>(*client));
  EXPECT_TRUE(client->wait_frame(20s));
}

INSTANTIATE_TEST_SUITE_P(BothWays, Faults,
                         ::testing::Values(Direction::ToServer, Direction::ToClient),
                         [](const auto& direction) {
                           return direction.param == Direction::ToServer ? "ToServer" : "ToClient";
                         });

/// A peer that vanishes behind something that keeps TCP alive: nothing comes and nothing fails.
/// Whether the server lets go of a descriptor within three seconds.
bool is_let_go_of(std::chrono::milliseconds most_silence) {
  TemporaryFolder keys;
  base::SteadyClock clock;
  ServerEndpointOptions options;
  options.bind = "tcp://127.0.0.1:*";
  options.key_folder = keys.path();
  options.most_silence = most_silence;
  const auto server = ServerEndpoint::create(options, clock);
  EXPECT_TRUE(server);
  auto proxy = ChaosProxy::create((*server)->endpoint());
  EXPECT_TRUE(proxy);
  auto client = make_client(client_options((*proxy)->endpoint(), keys.path()));
  EXPECT_TRUE((*server)->wait(20s));  // its Hello
  (*proxy)->leave_half_open();
  client.reset();
  std::this_thread::sleep_for(300ms);  // the client's own descriptors are gone
  const int held = open_descriptors();
  return eventually([&] { return open_descriptors() < held; }, 3s);
}

TEST(SilentConnection, IsClosedByTheServer) {
  EXPECT_TRUE(is_let_go_of(1s));
}

TEST(SilentConnection, WouldStayOpenIfSilenceWereAllowed) {
  EXPECT_FALSE(is_let_go_of(1h));
}

TEST(Recovery, ACutConnectionIsRecoveredFromWithinASecond) {
  TemporaryFolder keys;
  BusyServer server(keys.path());
  auto proxy = ChaosProxy::create(server.endpoint());
  ASSERT_TRUE(proxy);
  const auto client = make_client(client_options((*proxy)->endpoint(), keys.path()));
  expect_recovery_within_a_second(*client, [&] { (*proxy)->cut(); });
}

TEST(Recovery, AServerThatCameBackIsFoundWithinASecond) {
  TemporaryFolder keys;
  auto server = std::make_unique<BusyServer>(keys.path());
  const std::string endpoint = server->endpoint();
  const auto client = make_client(client_options(endpoint, keys.path()));
  ASSERT_TRUE(client->wait_frame(20s));
  Nanoseconds shortest = 1h;
  for (int attempt = 0; attempt < 5 && shortest > 1s; ++attempt) {
    server.reset();
    ASSERT_TRUE(next_event<Disconnected>(*client));
    std::this_thread::sleep_for(2s);  // the back-off has reached its longest
    while (client->wait_frame(0s)) {
    }
    server = std::make_unique<BusyServer>(keys.path(), endpoint);
    const auto start = std::chrono::steady_clock::now();
    ASSERT_TRUE(client->wait_frame(20s));
    shortest = std::min<Nanoseconds>(shortest, std::chrono::steady_clock::now() - start);
  }
  EXPECT_LE(shortest, 1s);
}

TEST(Recovery, AServerKilledMidFrameLeavesNoTornFrame) {
  TemporaryFolder keys;
  auto server = std::make_unique<PlainServer>(keys.path());
  auto proxy = ChaosProxy::create(server->endpoint().endpoint());
  ASSERT_TRUE(proxy);
  (*proxy)->shape(Direction::ToClient, {0ms, 0ms, 250e3, 16384});
  const auto client = make_client(client_options((*proxy)->endpoint(), keys.path()));
  ASSERT_TRUE(meet(*server, *client));
  server->endpoint().send_frame(server->peer(), make_frame(server->epoch(), 1, 400'000));
  ASSERT_TRUE(eventually([&] { return (*proxy)->bytes(Direction::ToClient) > 60'000; }));
  server.reset();
  ASSERT_TRUE(next_event<Disconnected>(*client));
  EXPECT_FALSE(client->wait_frame(0s));
  EXPECT_EQ(client->counters().frames, 0U);
}

/// A client behind 2 Mbit/s and a server that plays no session.
class SlowLink : public ::testing::Test {
 protected:
  void SetUp() override {
    auto proxy = ChaosProxy::create(server_.endpoint().endpoint());
    ASSERT_TRUE(proxy);
    proxy_ = std::move(*proxy);
    proxy_->shape(Direction::ToClient, {10ms, 0ms, 250e3, 32768});
    proxy_->shape(Direction::ToServer, {10ms, 0ms, 250e3, 32768});
    client_ = make_client(client_options(proxy_->endpoint(), keys_.path()));
    ASSERT_TRUE(meet(server_, *client_));
    peer_ = server_.peer();
  }
  TemporaryFolder keys_;
  PlainServer server_{keys_.path()};
  std::unique_ptr<ChaosProxy> proxy_;
  std::unique_ptr<ClientEndpoint> client_;
  PeerId peer_;
};

TEST_F(SlowLink, AFrameOf400kBArrivesWholeAndItsProgressIsAcknowledged) {
  const auto sent = make_frame(server_.epoch(), 1, 400'000);
  server_.endpoint().send_frame(peer_, sent);
  std::uint64_t progress = 0;
  int steps = 0;
  EXPECT_TRUE(eventually([&] {
    const auto view = server_.next<ViewReceived>(1s);
    if (!view) return false;
    if (view->acks.receiving == 1 && view->acks.receiving_bytes > progress) ++steps;
    progress = std::max(progress, view->acks.receiving_bytes);
    return view->acks.received == 1;
  }));
  EXPECT_GE(steps, 5);
  const auto frame = client_->wait_frame(20s);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->payloads[0], *sent.payloads[0]);
  EXPECT_EQ(client_->counters().socket_remakes, 0U);
  // 400 kB at 250 kB/s take 1.6 s.
  EXPECT_GE(frame->last_byte - frame->first_byte, 1s);
}

// A Ping is answered by the net thread while most of a frame still waits there; the Pong overtakes
// what libzmq and the kernel have not been given.
TEST_F(SlowLink, APingDoesNotWaitForTheWholeFrame) {
  ASSERT_TRUE(eventually([&] { return client_->clock().has_value(); }));
  server_.endpoint().send_frame(peer_, make_frame(server_.epoch(), 1, 1'500'000));  // 6 s of link
  const auto bound_before = client_->clock()->bound;
  ASSERT_TRUE(eventually([&] { return proxy_->bytes(Direction::ToClient) > 900'000; }));
  EXPECT_FALSE(client_->wait_frame(0s));
  const auto estimate = client_->clock();
  ASSERT_TRUE(estimate);
  EXPECT_LE(std::chrono::abs(estimate->server_minus_client), estimate->bound);
  EXPECT_LT(estimate->bound, bound_before + 20ms);
  EXPECT_EQ(client_->counters().socket_remakes, 0U);
}

}  // namespace
}  // namespace macula::net
