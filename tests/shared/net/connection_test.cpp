#include "shared/net/wire.h"
#include "tests/shared/net/net_fixture.h"

namespace macula::net {
namespace {

/// A welcomed client of a plain server.
class Connection : public ::testing::Test {
 protected:
  explicit Connection(const ServerDelays& delays = {})
      : server_(keys_.path(), "tcp://127.0.0.1:*", delays) {}

  std::unique_ptr<ClientEndpoint> join(const ClientDelays& delays = {}) {
    auto options = client_options(server_.endpoint().endpoint(), keys_.path());
    options.delays = delays;
    auto client = make_client(options);
    EXPECT_TRUE(meet(server_, *client));
    peer_ = server_.peer();
    return client;
  }
  void send(const EncodedFrame& frame) { server_.endpoint().send_frame(peer_, frame); }

  TemporaryFolder keys_;
  PlainServer server_;
  PeerId peer_;
};

TEST_F(Connection, AFrameArrivesBitEqualWithEverythingItWasMadeWith) {
  const auto client = join();
  EncodedFrame sent = make_frame(server_.epoch(), 1, 300'000);
  sent.begin.kernel = "ray";
  sent.begin.seed = 7;
  sent.begin.view_sampled = ClientTime{11ms};
  sent.end.render_begin = ServerTime{12ms};
  send(sent);
  const auto frame = client->wait_frame(20s);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->payloads.at(0), *sent.payloads[0]);
  EXPECT_EQ(encode_envelope(frame->begin), encode_envelope(sent.begin));
  EXPECT_EQ(encode_envelope(frame->end), encode_envelope(sent.end));
  EXPECT_LE(frame->first_byte, frame->last_byte);
}

TEST_F(Connection, TheServerKnowsTheClientByItsAuthenticatedKey) {
  const auto client = make_client(client_options(server_.endpoint().endpoint(), keys_.path()));
  const auto hello = server_.next<HelloReceived>();
  ASSERT_TRUE(hello);
  EXPECT_EQ(hello->client_key_z85, *load_public_key(keys_.path() + "/client.pub"));
  EXPECT_EQ(hello->hello.program, "test");
}

TEST_F(Connection, AFrameIsAcknowledgedAtOnce) {
  const auto client = join();
  send(make_frame(server_.epoch(), 1, 1000));
  bool acked = false;
  EXPECT_TRUE(eventually([&] {
    const auto view = server_.next<ViewReceived>(1s);
    acked = view && view->acks.epoch == server_.epoch() && view->acks.received == 1;
    return acked;
  }));
}

TEST_F(Connection, ThatAFrameWasSentIsTold) {
  const auto client = join();
  const ServerTime before = server_.now();
  send(make_frame(server_.epoch(), 1, 1000));
  const auto sent = server_.next<FrameSent>();
  ASSERT_TRUE(sent);
  EXPECT_FALSE(sent->lost);
  EXPECT_EQ(sent->frame, 1U);
  EXPECT_LE(before, sent->begin);
  EXPECT_LE(sent->begin, sent->end);
  server_.endpoint().send_frame(PeerId{999}, make_frame(server_.epoch(), 2, 10));
  const auto lost = server_.next<FrameSent>();
  ASSERT_TRUE(lost);
  EXPECT_TRUE(lost->lost);
}

TEST_F(Connection, TheNewestViewComesThroughWithItsAcks) {
  const auto client = join();
  for (std::uint64_t i = 1; i <= 500; ++i) client->publish(make_view(i));
  std::uint64_t newest = 0;
  EXPECT_TRUE(eventually([&] {
    const auto view = server_.next<ViewReceived>(1s);
    if (!view || !view->view) return false;
    EXPECT_GT(view->view->sequence, newest);
    newest = view->view->sequence;
    return newest == 500;
  }));
}

TEST_F(Connection, ARejectedViewIsCountedAndItsAcksAreTaken) {
  const auto client = join();
  ViewState bad = make_view(1);
  bad.stage_from_head.position.x = NAN;
  client->publish(bad);
  const auto view = server_.next<ViewReceived>();
  ASSERT_TRUE(view);
  EXPECT_FALSE(view->view);
  EXPECT_EQ(view->acks.epoch, server_.epoch());
  EXPECT_TRUE(eventually([&] { return server_.endpoint().counters().rejected_views == 1; }));
}

TEST_F(Connection, SettingsAndByeReachTheSession) {
  const auto client = join();
  client->send(Settings{4, "lossless", 0, "", 0.0});
  const auto settings = server_.next<SettingsReceived>();
  ASSERT_TRUE(settings);
  EXPECT_EQ(settings->settings.generation, 4U);
  client->send(Bye{"done", 0});
  const auto bye = server_.next<ByeReceived>();
  ASSERT_TRUE(bye);
  EXPECT_EQ(bye->bye.reason, "done");
}

TEST_F(Connection, AByeLeavesEvenWhenTheEndpointGoesAtOnce) {
  auto client = join();
  client->send(Bye{"done", 0});
  client.reset();
  EXPECT_TRUE(server_.next<ByeReceived>());
}

TEST_F(Connection, TwoClientsNeverSeeEachOthersFrames) {
  const auto first = join();
  const PeerId first_peer = peer_;
  const std::uint32_t first_epoch = server_.epoch();
  const auto second = join();
  const std::uint32_t second_epoch = server_.epoch();
  constexpr std::uint64_t kFrames = 12;  // below what may wait for a peer at once
  for (std::uint64_t i = 1; i <= kFrames; ++i) {
    server_.endpoint().send_frame(first_peer, make_frame(first_epoch, i, 20'000, 1));
    server_.endpoint().send_frame(peer_, make_frame(second_epoch, i, 20'000, 2));
  }
  const auto all_belong = [](ClientEndpoint& client, std::uint32_t epoch, std::uint64_t seed) {
    std::uint64_t newest = 0;
    while (newest < kFrames) {
      const auto frame = client.wait_frame(20s);
      if (!frame || frame->begin.epoch != epoch || frame->begin.frame <= newest) return false;
      newest = frame->begin.frame;
      if (frame->payloads[0] != *make_frame(epoch, newest, 20'000, seed).payloads[0]) return false;
    }
    return true;
  };
  EXPECT_TRUE(all_belong(*first, first_epoch, 1));
  EXPECT_TRUE(all_belong(*second, second_epoch, 2));
}

// One machine, one clock: the true offset is zero, so the estimate must lie within its own bound.
TEST_F(Connection, TheClockEstimateLiesWithinItsBound) {
  const auto client = join();
  ASSERT_TRUE(eventually([&] { return client->clock().has_value(); }));
  for (int i = 0; i < 50; ++i) {
    const auto estimate = client->clock();
    ASSERT_TRUE(estimate);
    EXPECT_LE(std::chrono::abs(estimate->server_minus_client), estimate->bound);
    std::this_thread::sleep_for(5ms);
  }
}

TEST_F(Connection, AnUnknownSessionIsGreetedAnewWithoutItsToken) {
  const auto client = join();
  server_.endpoint().send(peer_, Refusal{RefusalCode::UnknownSession, "say hello again"});
  const auto hello = server_.next<HelloReceived>();
  ASSERT_TRUE(hello);
  EXPECT_FALSE(hello->hello.resume_token);
  const auto welcomed = next_event<Welcomed>(*client);
  ASSERT_TRUE(welcomed);
  EXPECT_FALSE(welcomed->resumed);
}

TEST_F(Connection, FramesOfAnotherEpochAreNotShown) {
  const auto client = join();
  send(make_frame(server_.epoch() + 1, 1, 1000));
  send(make_frame(server_.epoch(), 1, 1000));
  const auto frame = client->wait_frame(20s);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->begin.epoch, server_.epoch());
}

TEST_F(Connection, EndpointsLeaveNoDescriptorBehind) {
  join().reset();
  const int before = open_descriptors();
  for (int i = 0; i < 20; ++i) {
    TemporaryFolder keys;
    PlainServer server(keys.path());
    const auto client = make_client(client_options(server.endpoint().endpoint(), keys.path()));
    ASSERT_TRUE(server.next<HelloReceived>());
    server.endpoint().send_frame(PeerId{1}, make_frame(server.epoch(), 1, 500'000));
  }
  // The server of the first connection may have closed its end only after `before` was counted.
  EXPECT_LE(open_descriptors(), before);
}

class DelayedSendQueue : public Connection {
 protected:
  DelayedSendQueue() : Connection(ServerDelays{30ms, 0ms}) {}
};
class DelayedDownlink : public Connection {
 protected:
  DelayedDownlink() : Connection(ServerDelays{0ms, 30ms}) {}
};

// The least of many: scheduling noise only ever adds.
TEST_F(DelayedSendQueue, LiesInTheSendQueueStageAndPingsPass) {
  const auto client = join();
  Nanoseconds least = 1s;
  for (std::uint64_t i = 1; i <= 10; ++i) {
    send(make_frame(server_.epoch(), i, 1000));
    const auto sent = server_.next<FrameSent>();
    ASSERT_TRUE(sent);
    least = std::min(least, sent->end - sent->begin);
  }
  EXPECT_GE(least, 30ms);
  EXPECT_LT(least, 31ms);
  ASSERT_TRUE(eventually([&] { return client->clock().has_value(); }));
  EXPECT_LT(client->clock()->min_rtt, 30ms);
}

TEST_F(DelayedDownlink, ComesAfterTheSendQueueStageAndPingsPass) {
  const auto client = join();
  Nanoseconds least = 1s;
  for (std::uint64_t i = 1; i <= 10; ++i) {
    send(make_frame(server_.epoch(), i, 1000));
    const auto sent = server_.next<FrameSent>();
    const auto frame = client->wait_frame(20s);
    ASSERT_TRUE(sent && frame);
    // Both clocks are this machine's.
    least = std::min(least, frame->last_byte.time_since_epoch() - sent->end.time_since_epoch());
  }
  EXPECT_GE(least, 30ms);
  EXPECT_LT(least, 31ms);
  EXPECT_LT(client->clock()->min_rtt, 30ms);
}

TEST_F(Connection, AnUplinkDelayHoldsViewsAndLetsPingsPass) {
  const auto client = join({30ms});
  Nanoseconds least = 1s;
  for (std::uint64_t i = 1; i <= 10; ++i) {
    const ServerTime published = server_.now();
    client->publish(make_view(i));
    std::optional<ViewReceived> view;
    while ((view = server_.next<ViewReceived>()) && !view->view) {
    }
    ASSERT_TRUE(view);
    EXPECT_EQ(view->view->sequence, i);
    least = std::min(least, view->received - published);
  }
  EXPECT_GE(least, 30ms);
  EXPECT_LT(least, 31ms);
  EXPECT_LT(client->clock()->min_rtt, 30ms);
}

}  // namespace
}  // namespace macula::net
