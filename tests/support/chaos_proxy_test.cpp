// The proxy against plain sockets: what it promises to do to a link is what bytes meet on it, and
// it does nothing else.
#include "tests/support/chaos_proxy.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <thread>

#include "shared/base/text.h"
#include "tests/support/handed_data.h"
#include "tests/support/link_trace.h"

namespace macula::support {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using Bytes = std::vector<std::uint8_t>;

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// A connected TCP socket; reads wait at most ten seconds.
class Plug {
 public:
  explicit Plug(int fd) : fd_(fd) {
    const timeval patience{10, 0};
    ::setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    const int on = 1;
    ::setsockopt(fd_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  }
  Plug(Plug&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  ~Plug() {
    if (fd_ >= 0) ::close(fd_);
  }
  void send(const Bytes& bytes) const {
    std::size_t sent = 0;
    while (sent < bytes.size()) {
      const ssize_t count = ::send(fd_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
      if (count <= 0) return;
      sent += static_cast<std::size_t>(count);
    }
  }
  /// As many bytes as came before an end, an error or ten seconds of silence.
  Bytes receive(std::size_t count) const {
    Bytes bytes(count);
    std::size_t came = 0;
    while (came < count) {
      const ssize_t now = ::recv(fd_, bytes.data() + came, count - came, 0);
      if (now <= 0) break;
      came += static_cast<std::size_t>(now);
    }
    bytes.resize(came);
    return bytes;
  }
  /// 0: the other end closed; errno of a failed read; -1: nothing within `wait`.
  int state(std::chrono::milliseconds wait) const {
    pollfd poll{fd_, POLLIN, 0};
    if (::poll(&poll, 1, static_cast<int>(wait.count())) == 0) return -1;
    char byte = 0;
    return ::recv(fd_, &byte, 1, MSG_PEEK) == 0 ? 0 : errno;
  }

 private:
  int fd_;
};

sockaddr_in address_of(const std::string& endpoint) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port =
      htons(static_cast<std::uint16_t>(std::stoi(endpoint.substr(endpoint.rfind(':') + 1))));
  return address;
}

/// A listener behind a proxy, and connections through it.
class ThroughAProxy : public testing::Test {
 protected:
  void SetUp() override {
    listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in own = address_of("tcp://127.0.0.1:0");
    socklen_t size = sizeof own;
    auto* const raw = reinterpret_cast<sockaddr*>(&own);
    ASSERT_EQ(::bind(listener_, raw, size), 0);
    ASSERT_EQ(::listen(listener_, 8), 0);
    ASSERT_EQ(::getsockname(listener_, raw, &size), 0);
    auto proxy = ChaosProxy::create(base::concat("tcp://127.0.0.1:", ntohs(own.sin_port)), 7);
    ASSERT_TRUE(proxy);
    proxy_ = std::move(*proxy);
  }
  void TearDown() override { ::close(listener_); }

  std::pair<Plug, Plug> connect() {
    const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const sockaddr_in address = address_of(proxy_->endpoint());
    EXPECT_EQ(::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    return {Plug(fd), Plug(::accept(listener_, nullptr, nullptr))};
  }

  int listener_ = -1;
  std::unique_ptr<ChaosProxy> proxy_;
};

Bytes numbered(std::size_t count) {
  Bytes bytes(count);
  for (std::size_t i = 0; i < count; ++i) bytes[i] = static_cast<std::uint8_t>(i * 131 + i / 256);
  return bytes;
}

/// How long a byte takes from one end to the other. A busy machine only ever adds time, so the
/// least of several is what the link itself takes.
double one_way_ms(const Plug& from, const Plug& to) {
  double least = 1e9;
  for (int i = 0; i < 15; ++i) {
    const auto start = Clock::now();
    from.send({42});
    EXPECT_EQ(to.receive(1).size(), 1U);
    least = std::min(least, ms_since(start));
  }
  return least;
}

TEST_F(ThroughAProxy, BytesArriveUnchangedBothWays) {
  auto [client, server] = connect();
  const Bytes sent = numbered(300'000);
  std::thread sender([&] { client.send(sent); });
  EXPECT_EQ(server.receive(sent.size()), sent);
  sender.join();
  std::thread answer([&] { server.send(sent); });
  EXPECT_EQ(client.receive(sent.size()), sent);
  answer.join();
  EXPECT_EQ(proxy_->bytes(Direction::ToServer), sent.size());
  EXPECT_EQ(proxy_->bytes(Direction::ToClient), sent.size());
}

TEST_F(ThroughAProxy, ADelayIsMetWithinAMillisecondInItsDirectionAndNotInTheOther) {
  auto [client, server] = connect();
  const double up_plain = one_way_ms(client, server), down_plain = one_way_ms(server, client);
  proxy_->shape(Direction::ToServer, {.delay = 20ms});
  EXPECT_NEAR(one_way_ms(client, server) - up_plain, 20.0, 1.0);
  EXPECT_NEAR(one_way_ms(server, client) - down_plain, 0.0, 1.0);
}

TEST_F(ThroughAProxy, JitterAddsUpToItsRangeAndKeepsOrder) {
  auto [client, server] = connect();
  proxy_->shape(Direction::ToServer, {.delay = 5ms, .jitter = 10ms});
  double least = 1e9, most = 0.0;
  for (std::uint8_t i = 0; i < 30; ++i) {
    const auto start = Clock::now();
    client.send({i});
    EXPECT_EQ(server.receive(1), Bytes{i});
    least = std::min(least, ms_since(start));
    most = std::max(most, ms_since(start));
  }
  EXPECT_GE(least, 5.0);
  EXPECT_GE(most - least, 5.0) << "30 draws from 10 ms lie within 5 ms once in 10^8";
}

TEST_F(ThroughAProxy, ARateLimitLetsNoMoreThroughThanItSays) {
  auto [client, server] = connect();
  proxy_->shape(Direction::ToServer, {.bytes_per_s = 2e6});
  const Bytes sent = numbered(400'000);
  const auto start = Clock::now();
  std::thread sender([&] { client.send(sent); });
  EXPECT_EQ(server.receive(sent.size()), sent);
  sender.join();
  EXPECT_GE(ms_since(start), 200.0 - 6.0) << "one burst of 5 ms may leave at once";
}

// 40 messages one by one, each lost with chance .5: 20 +- 3.2 of them.
TEST_F(ThroughAProxy, ALossShowsAsAStall) {
  auto [client, server] = connect();
  proxy_->shape(Direction::ToServer, {.loss = 0.5, .loss_stall = 10ms});
  int stalled = 0;
  for (int i = 0; i < 40; ++i) {
    const auto start = Clock::now();
    client.send({1});
    ASSERT_EQ(server.receive(1).size(), 1U);
    stalled += ms_since(start) >= 9.9 ? 1 : 0;
  }
  EXPECT_GE(stalled, 20 - 13) << "four standard deviations below the mean";
}

// 400 packets of which 40 are lost at once: one by one they would stall for two seconds.
TEST_F(ThroughAProxy, LossesOfOneFlightAreMendedTogether) {
  auto [client, server] = connect();
  proxy_->shape(Direction::ToServer, {.loss = 0.1, .loss_stall = 50ms});
  const Bytes sent = numbered(400 * 1448);
  const auto start = Clock::now();
  std::thread sender([&] { client.send(sent); });
  EXPECT_EQ(server.receive(sent.size()), sent);
  sender.join();
  EXPECT_GE(ms_since(start), 49.9);
  EXPECT_LT(ms_since(start), 1000.0);
}

TEST_F(ThroughAProxy, ATraceChangesTheLinkAtItsTimesAndBeginsAgain) {
  auto [client, server] = connect();
  LinkTrace trace;
  trace.steps = {{0ms, {.delay = 0ms}}, {200ms, {.delay = 30ms}}};
  trace.lasts = 400ms;
  proxy_->follow(Direction::ToServer, trace);
  const auto start = Clock::now();
  std::array<double, 4> least{1e9, 1e9, 1e9, 1e9};
  while (ms_since(start) < 790.0) {
    const double sent_at = ms_since(start);
    client.send({1});
    ASSERT_EQ(server.receive(1).size(), 1U);
    // Near a change nobody knows which side a byte was on.
    const bool is_inside = std::fmod(sent_at, 200.0) > 20.0 && std::fmod(sent_at, 200.0) < 180.0;
    double& quarter = least[std::min(static_cast<std::size_t>(sent_at / 200.0), std::size_t{3})];
    if (is_inside) quarter = std::min(quarter, ms_since(start) - sent_at);
    std::this_thread::sleep_for(2ms);
  }
  EXPECT_LT(least[0], 10.0);
  EXPECT_GE(least[1], 29.0);
  EXPECT_LT(least[2], 10.0);
  EXPECT_GE(least[3], 29.0);
}

TEST_F(ThroughAProxy, OneBitIsFlippedInTheByteAskedFor) {
  auto [client, server] = connect();
  proxy_->flip_bit_after(Direction::ToServer, 700);
  const Bytes sent = numbered(2000);
  client.send(sent);
  const Bytes came = server.receive(sent.size());
  ASSERT_EQ(came.size(), sent.size());
  for (std::size_t i = 0; i < sent.size(); ++i) {
    const unsigned changed = sent[i] ^ came[i];
    EXPECT_EQ(std::popcount(changed), i == 700 ? 1 : 0) << "byte " << i;
  }
}

TEST_F(ThroughAProxy, AStallHoldsBytesAndAResumeBringsThem) {
  auto [client, server] = connect();
  proxy_->stall(Direction::ToServer);
  client.send({9});
  EXPECT_EQ(server.state(50ms), -1);
  proxy_->resume(Direction::ToServer);
  EXPECT_EQ(server.receive(1), Bytes{9});
}

TEST_F(ThroughAProxy, ACutIsAnEndAndAResetIsAnError) {
  {
    auto [client, server] = connect();
    proxy_->cut();
    EXPECT_EQ(client.state(10s), 0);
    EXPECT_EQ(server.state(10s), 0);
  }
  auto [client, server] = connect();
  proxy_->reset();
  EXPECT_EQ(client.state(10s), ECONNRESET);
  EXPECT_EQ(server.state(10s), ECONNRESET);
}

TEST_F(ThroughAProxy, AHalfOpenConnectionTakesBytesAndTellsNobody) {
  auto [client, server] = connect();
  proxy_->leave_half_open();
  client.send(numbered(100'000));
  EXPECT_EQ(server.state(50ms), -1) << "nothing comes, and no end either";
  { const Plug gone = std::move(client); }
  EXPECT_EQ(server.state(50ms), -1) << "the other end's close is not heard";
  auto [next_client, next_server] = connect();
  next_client.send({5});
  EXPECT_EQ(next_server.receive(1), Bytes{5});
}

TEST(LinkTrace, ReadsEveryRecordingHandedIn) {
  MACULA_NEEDS_HANDED_DATA("network/lte_att_driving2016_down.csv");
  const auto lte =
      load_link_trace((test::handed_data() / "network/lte_att_driving2016_down.csv").string());
  ASSERT_TRUE(lte);
  EXPECT_NEAR(lte->steps[1].shape.bytes_per_s, 26.76e6 / 8.0, 1.0);
  EXPECT_NEAR(static_cast<double>(lte->lasts.count()), 120e9, 0.2e9);
  const auto cellular =
      load_link_trace((test::handed_data() / "network/5g_public_n78_urban_60hz.csv").string());
  ASSERT_TRUE(cellular);
  EXPECT_EQ(cellular->steps[0].shape.delay, 12500us) << "half of the round trip of 25 ms";
}

TEST(LinkTrace, AFileWithoutItsColumnsIsRefusedByName) {
  const std::string path = testing::TempDir() + "not_a_link.csv";
  std::ofstream(path) << "t_s,speed\n0,1\n";
  const auto refused = load_link_trace(path);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message().find("not_a_link.csv:1"), std::string::npos);
}

}  // namespace
}  // namespace macula::support
