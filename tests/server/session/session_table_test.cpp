#include "server/session/session_table.h"

#include <gtest/gtest.h>

#include "shared/codec/h264.h"
#include "tests/server/session/session_fixtures.h"

namespace macula::session {
namespace {

using test::all_of;
using test::at_ms;

class SessionTableTest : public testing::Test {
 protected:
  Actions say_hello(std::uint64_t peer, const std::string& key, double ms,
                    std::optional<net::ResumeToken> token = std::nullopt) {
    net::Hello hello = test::hello();
    hello.resume_token = token;
    return table_.handle(net::HelloReceived{net::PeerId{peer}, key, hello, at_ms(ms)}, at_ms(ms));
  }
  net::Welcome welcome(std::uint64_t peer, const std::string& key, double ms,
                       std::optional<net::ResumeToken> token = std::nullopt) {
    const auto welcomes = all_of<SendWelcome>(say_hello(peer, key, ms, token));
    EXPECT_EQ(welcomes.size(), 1U);
    return welcomes.empty() ? net::Welcome{} : welcomes[0].welcome;
  }
  Actions see(std::uint64_t peer, std::uint64_t sequence, double ms) {
    return table_.handle(net::ViewReceived{net::PeerId{peer}, test::view(sequence), {}, at_ms(ms)},
                         at_ms(ms));
  }
  static ServerOffer offer() {
    ServerOffer offer;
    offer.kernel = "ray";
    offer.scene.name = "cornell";
    return offer;
  }

  SessionTable table_{SessionRules{}, offer(), test::counted_bits()};
};

TEST_F(SessionTableTest, WelcomesWithSessionEpochTokenAndScene) {
  const net::Welcome w = welcome(1, "alice", 0);
  EXPECT_NE(w.session, 0U);
  EXPECT_NE(w.epoch, 0U);
  EXPECT_NE(w.resume_token, net::ResumeToken{});
  EXPECT_EQ(w.color_codec, "jpeg");
  EXPECT_EQ(w.kernel, "ray");
  EXPECT_EQ(w.scene.name, "cornell");
  EXPECT_EQ(w.frame_window, 2U);
}

TEST_F(SessionTableTest, AResumeTokenKeepsTheSessionAndBeginsANewEpoch) {
  const net::Welcome first = welcome(1, "alice", 0);
  const Actions again = say_hello(2, "alice", 100, first.resume_token);
  const auto second = all_of<SendWelcome>(again);
  ASSERT_EQ(second.size(), 1U);
  EXPECT_EQ(second[0].welcome.session, first.session);
  EXPECT_NE(second[0].welcome.epoch, first.epoch);
  EXPECT_EQ(table_.sessions().size(), 1U);
  EXPECT_EQ(table_.counters().resumed, 1U);
}

TEST_F(SessionTableTest, ATokenIsWorthNothingUnderAnotherKey) {
  const net::Welcome alice = welcome(1, "alice", 0);
  const net::Welcome mallory = welcome(2, "mallory", 1, alice.resume_token);
  EXPECT_NE(mallory.session, alice.session);
  EXPECT_EQ(table_.sessions().size(), 2U);
}

TEST_F(SessionTableTest, ASecondConnectionOfTheSameKeyReplacesTheFirst) {
  const net::Welcome first = welcome(1, "alice", 0);
  const Actions actions = say_hello(2, "alice", 1);
  const auto byes = all_of<SendBye>(actions);
  ASSERT_EQ(byes.size(), 1U);
  EXPECT_EQ(byes[0].peer, net::PeerId{1});
  const auto dropped = all_of<DropSession>(actions);
  ASSERT_EQ(dropped.size(), 1U);
  EXPECT_EQ(dropped[0].session, first.session);
  EXPECT_EQ(table_.sessions().size(), 1U);
  EXPECT_EQ(table_.sessions().begin()->second.peer(), net::PeerId{2});
}

TEST_F(SessionTableTest, AFullServerRefusesAndSaysWhatToDo) {
  const SessionRules rules;
  for (std::uint64_t i = 0; i < rules.most_sessions; ++i)
    welcome(i, "client" + std::to_string(i), 0);
  const auto refusals = all_of<SendRefusal>(say_hello(99, "one too many", 1));
  ASSERT_EQ(refusals.size(), 1U);
  EXPECT_EQ(refusals[0].refusal.code, net::RefusalCode::ServerFull);
  EXPECT_NE(refusals[0].refusal.text.find("try again"), std::string::npos);
}

TEST_F(SessionTableTest, AViewFromAnUnknownPeerIsAnsweredOncePerInterval) {
  const auto first = all_of<SendRefusal>(see(5, 1, 0));
  ASSERT_EQ(first.size(), 1U);
  EXPECT_EQ(first[0].refusal.code, net::RefusalCode::UnknownSession);
  EXPECT_TRUE(see(5, 2, 50).empty());
  EXPECT_EQ(all_of<SendRefusal>(see(5, 3, 101)).size(), 1U);
}

TEST_F(SessionTableTest, AnotherProtocolVersionIsRefusedNamingBoth) {
  net::Hello hello = test::hello();
  hello.protocol_version = 9;
  const auto refusals = all_of<SendRefusal>(
      table_.handle(net::HelloReceived{net::PeerId{1}, "alice", hello, at_ms(0)}, at_ms(0)));
  ASSERT_EQ(refusals.size(), 1U);
  EXPECT_EQ(refusals[0].refusal.code, net::RefusalCode::VersionMismatch);
  EXPECT_NE(refusals[0].refusal.text.find("version 1"), std::string::npos);
  EXPECT_NE(refusals[0].refusal.text.find("version 9"), std::string::npos);
}

TEST_F(SessionTableTest, AHelloThatAsksForTheImpossibleIsABadRequest) {
  net::Hello hello = test::hello();
  hello.eyes[1].width_px = 100000;
  const auto refusals = all_of<SendRefusal>(
      table_.handle(net::HelloReceived{net::PeerId{1}, "alice", hello, at_ms(0)}, at_ms(0)));
  ASSERT_EQ(refusals.size(), 1U);
  EXPECT_EQ(refusals[0].refusal.code, net::RefusalCode::BadRequest);
  EXPECT_TRUE(table_.sessions().empty());
}

TEST_F(SessionTableTest, ASilentSessionIsFreedAfterThreeSeconds) {
  welcome(1, "alice", 0);
  see(1, 1, 10);
  EXPECT_TRUE(all_of<DropSession>(table_.tick(at_ms(3010))).empty());
  EXPECT_EQ(all_of<DropSession>(table_.tick(at_ms(3011))).size(), 1U);
  EXPECT_TRUE(table_.sessions().empty());
  EXPECT_EQ(all_of<SendRefusal>(see(1, 2, 3020)).size(), 1U) << "it must say Hello again";
}

TEST_F(SessionTableTest, ByeFreesTheSessionAtOnce) {
  welcome(1, "alice", 0);
  const Actions actions = table_.handle(net::ByeReceived{net::PeerId{1}, {"done", 0}}, at_ms(1));
  EXPECT_EQ(all_of<DropSession>(actions).size(), 1U);
  EXPECT_EQ(all_of<AbandonFrames>(actions).size(), 1U);
}

TEST_F(SessionTableTest, SessionsTakeTurnsOnTheRenderer) {
  const std::uint64_t a = welcome(1, "alice", 0).session, b = welcome(2, "bob", 0).session;
  std::map<std::uint64_t, int> served;
  for (std::uint64_t i = 1; i <= 6; ++i) {
    see(1, i, static_cast<double>(i));
    see(2, i, static_cast<double>(i));
    const auto start = table_.next_frame(at_ms(static_cast<double>(i)));
    ASSERT_TRUE(start);
    ++served[start->key.session];
    table_.on_frame_abandoned(start->key);
  }
  EXPECT_EQ(served[a], 3);
  EXPECT_EQ(served[b], 3);
}

/// Two clients that always want a frame; one's take three times as long. Milliseconds each got of
/// the renderer.
class SharedRenderer : public SessionTableTest {
 protected:
  enum class Costs { Told, Kept };
  std::map<std::string, double> render_frames(int frames, Costs costs) {
    std::map<std::string, double> got;
    for (int i = 0; i < frames; ++i) {
      ++sequence_;
      see(1, sequence_, now_ms_);
      see(2, sequence_, now_ms_);
      const auto start = table_.next_frame(at_ms(now_ms_));
      EXPECT_TRUE(start);
      if (!start) break;
      const bool is_slow = start->peer == net::PeerId{1};
      const double cost_ms = is_slow ? 30.0 : 10.0;
      got[is_slow ? "slow" : "quick"] += cost_ms;
      now_ms_ += cost_ms;
      if (costs == Costs::Told) table_.on_rendered(start->key, units::from_ms(cost_ms));
      table_.on_frame_abandoned(start->key);
    }
    return got;
  }
  std::uint64_t sequence_ = 0;
  double now_ms_ = 0.0;
};

TEST_F(SharedRenderer, IsSharedByTimeNotByFrames) {
  welcome(1, "alice", 0);
  welcome(2, "bob", 0);
  auto got = render_frames(400, Costs::Told);
  EXPECT_NEAR(got["slow"], got["quick"], 30.0) << "at most one frame apart";
}

/// The twin: were costs not told, frames would be equal and the slow client take three quarters.
TEST_F(SharedRenderer, WouldBeSharedByFramesIfCostsWereNotTold) {
  welcome(1, "alice", 0);
  welcome(2, "bob", 0);
  auto got = render_frames(400, Costs::Kept);
  EXPECT_NEAR(got["slow"], 3.0 * got["quick"], 30.0);
}

TEST_F(SharedRenderer, OwesNothingToAClientThatWasIdle) {
  welcome(1, "alice", 0);
  for (int i = 0; i < 100; ++i, now_ms_ += 30.0) {
    see(1, ++sequence_, now_ms_);
    const auto start = table_.next_frame(at_ms(now_ms_));
    ASSERT_TRUE(start);
    table_.on_rendered(start->key, units::from_ms(30.0));
    table_.on_frame_abandoned(start->key);
  }
  welcome(2, "bob", now_ms_);
  auto got = render_frames(40, Costs::Told);
  EXPECT_NEAR(got["slow"], got["quick"], 60.0);
}

TEST_F(SessionTableTest, BadSettingsChangeNothingAndAreCounted) {
  welcome(1, "alice", 0);
  net::Settings bad;
  bad.generation = 1;
  bad.rate_model = "no such curve";
  table_.handle(net::SettingsReceived{net::PeerId{1}, bad}, at_ms(1));
  EXPECT_EQ(table_.counters().rejected_settings, 1U);
  EXPECT_EQ(table_.sessions().begin()->second.setup().settings.generation, 0U);

  net::Settings good;
  good.generation = 2;
  good.rate_model = "cortical";
  table_.handle(net::SettingsReceived{net::PeerId{1}, good}, at_ms(2));
  EXPECT_EQ(table_.sessions().begin()->second.setup().settings.generation, 2U);
  EXPECT_EQ(table_.sessions().begin()->second.setup().settings.color_codec, "jpeg");
}

TEST_F(SessionTableTest, StoppingSaysByeToEverybody) {
  welcome(1, "alice", 0);
  welcome(2, "bob", 0);
  EXPECT_EQ(all_of<SendBye>(table_.stop("done")).size(), 2U);
  EXPECT_TRUE(table_.sessions().empty());
}

TEST(Hello, NegotiatesACodecBothSidesSpeak) {
  net::Hello hello = test::hello();
  hello.codecs = {"lossless"};
  EXPECT_EQ(check_hello(hello, {})->settings.color_codec, "lossless");
  hello.codecs = {"av1"};
  EXPECT_FALSE(check_hello(hello, {}));
  hello.codecs = {"lossless", "jpeg", "h264"};
  EXPECT_EQ(check_hello(hello, {})->settings.color_codec,
            codec::can_encode_h264() ? "h264" : "jpeg");
  ServerOffer jpeg;
  jpeg.default_codec = "jpeg";
  EXPECT_EQ(check_hello(hello, jpeg)->settings.color_codec, "jpeg");
  EXPECT_EQ(check_settings({.color_codec = "h264"}).has_value(), codec::can_encode_h264());
  hello.codecs = {"jpeg", "lossless"};
  hello.settings.color_codec = "lossless";
  EXPECT_EQ(check_hello(hello, {})->settings.color_codec, "lossless");
}

TEST(Hello, RefusesWhatCannotBeRendered) {
  const auto refused = [](auto change) {
    net::Hello hello = test::hello();
    change(hello);
    return !check_hello(hello, {}).has_value();
  };
  EXPECT_FALSE(refused([](net::Hello&) {}));
  EXPECT_TRUE(refused([](net::Hello& h) { h.eyes.clear(); }));
  EXPECT_TRUE(refused([](net::Hello& h) { h.eyes.resize(3, test::small_display()); }));
  EXPECT_TRUE(refused([](net::Hello& h) { h.eyes[0].height_px = 0; }));
  EXPECT_TRUE(refused([](net::Hello& h) { h.eyes[0].fov.left = Degrees{50.0}; }));
  EXPECT_TRUE(refused([](net::Hello& h) { h.refresh_hz = 0.0; }));
  EXPECT_TRUE(refused([](net::Hello& h) { h.settings.jpeg_quality = 101; }));
  EXPECT_TRUE(refused([](net::Hello& h) { h.settings.fovea_oversampling = 1.3; }));
}

}  // namespace
}  // namespace macula::session
