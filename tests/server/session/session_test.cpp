#include "server/session/session.h"

#include <gtest/gtest.h>
#include <cmath>
#include <limits>

#include "tests/server/session/session_fixtures.h"

namespace macula::session {
namespace {

using test::all_of;
using test::at_ms;

constexpr net::PeerId kPeer{7};
constexpr std::uint32_t kEpoch = 100;

net::Welcome welcome(std::uint32_t epoch) {
  net::Welcome welcome;
  welcome.session = 1;
  welcome.epoch = epoch;
  return welcome;
}

class SessionTest : public testing::Test {
 protected:
  SessionTest() { session_.begin_epoch(kPeer, welcome(kEpoch), test::setup(), at_ms(0)); }

  Actions see(std::uint64_t sequence, double ms, std::uint64_t received = 0,
              std::uint32_t epoch = kEpoch) {
    net::Acks acks;
    acks.epoch = epoch;
    acks.received = received;
    return session_.on_view({kPeer, test::view(sequence), acks, at_ms(ms)});
  }
  /// Renders and encodes in no time.
  std::optional<FrameKey> make_frame(double ms) {
    const auto start = session_.start_frame(at_ms(ms));
    if (!start) return std::nullopt;
    session_.on_frame_ready(start->key, at_ms(ms));
    return start->key;
  }

  Session session_{1, "key", SessionRules{}};
};

TEST_F(SessionTest, RendersNothingBeforeTheFirstView) {
  EXPECT_FALSE(session_.start_frame(at_ms(1)));
}

TEST_F(SessionTest, StartsFromTheNewestViewAndFromEachViewOnce) {
  see(1, 1);
  see(2, 2);
  const auto start = session_.start_frame(at_ms(3));
  ASSERT_TRUE(start);
  EXPECT_EQ(start->view.sequence, 2U);
  EXPECT_EQ(start->view_received, at_ms(2));
  EXPECT_EQ(start->key, (FrameKey{1, kEpoch, 1}));
  EXPECT_FALSE(session_.start_frame(at_ms(3)));
}

TEST_F(SessionTest, DropsViewsThatAreNotNewerAndCountsThem) {
  see(5, 1);
  see(4, 2);
  see(5, 3);
  EXPECT_EQ(session_.start_frame(at_ms(4))->view.sequence, 5U);
  EXPECT_EQ(session_.counters().stale_views, 2U);
}

TEST_F(SessionTest, RejectsViewsThatCouldNotBeRenderedButTakesTheirAcks) {
  see(1, 0);
  make_frame(0);
  net::ViewState bad = test::view(2);
  bad.stage_from_head.position.x = std::numeric_limits<double>::quiet_NaN();
  session_.on_view({kPeer, bad, {kEpoch, 1, 0, 0, false}, at_ms(5)});
  EXPECT_EQ(session_.counters().invalid_views, 1U);
  EXPECT_EQ(session_.credit().in_flight(), 0);
  EXPECT_FALSE(session_.start_frame(at_ms(6)));

  session_.on_view({kPeer, test::view(3, 1), {kEpoch, 1, 0, 0, false}, at_ms(7)});
  EXPECT_EQ(session_.counters().invalid_views, 2U) << "one eye where Hello announced two";
}

TEST_F(SessionTest, StopsRenderingHalfASecondAfterTheLastViewAndIsFreedAfterThree) {
  see(1, 0);
  EXPECT_TRUE(session_.may_start(at_ms(500)));
  EXPECT_FALSE(session_.may_start(at_ms(501)));
  EXPECT_FALSE(session_.is_expired(at_ms(3000)));
  EXPECT_TRUE(session_.is_expired(at_ms(3001)));
}

TEST_F(SessionTest, ASilentClientsUnsentFramesAreAbandoned) {
  see(1, 0);
  const auto start = session_.start_frame(at_ms(1));
  EXPECT_TRUE(session_.tick(at_ms(400)).empty());
  const auto abandon = all_of<AbandonFrames>(session_.tick(at_ms(600)));
  ASSERT_EQ(abandon.size(), 1U);
  EXPECT_EQ(abandon[0].epoch, kEpoch);
  session_.on_frame_abandoned(start->key);
  EXPECT_EQ(session_.credit().unsent(), 0);
  EXPECT_TRUE(session_.tick(at_ms(610)).empty());
}

TEST_F(SessionTest, HoldsAReadyFrameUntilAnAcknowledgementReturnsCredit) {
  for (std::uint64_t i = 1; i <= 2; ++i) {
    see(i, static_cast<double>(i));
    ASSERT_TRUE(make_frame(static_cast<double>(i)));
  }
  see(3, 3);
  const auto third = session_.start_frame(at_ms(3));
  ASSERT_TRUE(third) << "one more may be rendering";
  EXPECT_TRUE(session_.on_frame_ready(third->key, at_ms(4)).empty());
  EXPECT_EQ(session_.credit().in_flight(), 2);

  const auto released = all_of<ReleaseFrame>(see(4, 10, 1));
  ASSERT_EQ(released.size(), 1U);
  EXPECT_EQ(released[0].key.frame, 3U);
  EXPECT_EQ(session_.counters().most_in_flight_excess, 0);
}

TEST_F(SessionTest, ALostAcknowledgementCostsASecondAndNoMore) {
  see(1, 0);
  make_frame(0);
  see(2, 1);
  make_frame(1);
  see(3, 2);
  const auto held = make_frame(2);
  ASSERT_TRUE(held);
  Actions released;
  for (double ms = 10; ms <= 1100 && released.empty(); ms += 10) {
    see(static_cast<std::uint64_t>(ms), ms);
    released = session_.tick(at_ms(ms));
  }
  ASSERT_EQ(all_of<ReleaseFrame>(released).size(), 1U);
  EXPECT_EQ(session_.counters().frames_lost, 2U) << "both frames in flight waited for it";
}

TEST_F(SessionTest, AFrameTheNetworkDroppedReturnsItsCreditAtOnce) {
  see(1, 0);
  const auto key = make_frame(0);
  session_.on_frame_sent({kPeer, kEpoch, key->frame, at_ms(1), at_ms(1), true}, at_ms(1));
  EXPECT_EQ(session_.credit().in_flight(), 0);
  EXPECT_EQ(session_.counters().frames_lost, 1U);
}

TEST_F(SessionTest, ANewEpochForgetsCreditViewsAndFrameIds) {
  see(9, 0);
  make_frame(0);
  see(10, 1);
  session_.start_frame(at_ms(1));
  const auto abandoned = all_of<AbandonFrames>(
      session_.begin_epoch(kPeer, welcome(kEpoch + 1), test::setup(), at_ms(2)));
  ASSERT_EQ(abandoned.size(), 1U);
  EXPECT_EQ(abandoned[0].epoch, kEpoch);
  EXPECT_EQ(session_.credit().in_flight() + session_.credit().unsent(), 0);
  see(1, 3, 0, kEpoch + 1);
  const auto start = session_.start_frame(at_ms(3));
  ASSERT_TRUE(start) << "view sequences may restart in a new epoch";
  EXPECT_EQ(start->key.frame, 1U);
}

TEST_F(SessionTest, AcknowledgementsOfAnotherEpochAreIgnored) {
  see(1, 0);
  make_frame(0);
  see(2, 1, 1, kEpoch - 1);
  EXPECT_EQ(session_.credit().in_flight(), 1);
  EXPECT_EQ(session_.counters().foreign_acks, 1U);
}

// On one connection no message is lost, but a full pipe may drop a Welcome: the client then waits
// for frames of an epoch it has never heard of.
TEST_F(SessionTest, AClientThatMissedItsWelcomeHearsItAgain) {
  EXPECT_TRUE(see(1, 199, 0, kEpoch - 1).empty())
      << "views of the old epoch may still be on their way";
  const auto again = all_of<SendWelcome>(see(2, 201, 0, kEpoch - 1));
  ASSERT_EQ(again.size(), 1U);
  EXPECT_EQ(again[0].welcome.epoch, kEpoch);
  EXPECT_TRUE(see(3, 215, 0, kEpoch - 1).empty());
  EXPECT_EQ(all_of<SendWelcome>(see(4, 402, 0, kEpoch - 1)).size(), 1U);
  EXPECT_TRUE(all_of<SendWelcome>(see(5, 700)).empty());
}

TEST_F(SessionTest, AcknowledgementsAboveTheLastSentFrameAreRefusedAndCounted) {
  see(1, 0);
  make_frame(0);
  see(2, 1, 40);
  EXPECT_EQ(session_.credit().in_flight(), 1);
  EXPECT_EQ(session_.counters().acks_refused, 1U);
}

TEST_F(SessionTest, FramesOfAnEarlierEpochAreNeverReleased) {
  see(1, 0);
  const auto old = session_.start_frame(at_ms(0));
  session_.begin_epoch(kPeer, welcome(kEpoch + 1), test::setup(), at_ms(1));
  EXPECT_TRUE(session_.on_frame_ready(old->key, at_ms(2)).empty());
}

TEST_F(SessionTest, SettingsApplyToFramesStartedLater) {
  see(1, 0);
  const auto before = session_.start_frame(at_ms(0));
  net::Settings settings;
  settings.generation = 3;
  session_.on_settings(settings);
  see(2, 1);
  const auto after = session_.start_frame(at_ms(1));
  EXPECT_EQ(before->setup->settings.generation, 0U);
  EXPECT_EQ(after->setup->settings.generation, 3U);
}

TEST_F(SessionTest, AClientThatLostAFrameGetsOneKeyFrameAndNotOneForEveryWish) {
  see(1, 0);
  EXPECT_FALSE(session_.start_frame(at_ms(1))->is_key_wanted) << "the first is one anyway";
  session_.on_frame_ready({1, kEpoch, 1}, at_ms(1));
  net::Acks lost;
  lost.epoch = kEpoch;
  lost.received = 1;
  lost.need_key = true;
  const auto wish = [&](std::uint64_t sequence, double ms) {
    session_.on_view({kPeer, test::view(sequence), lost, at_ms(ms)});
    const auto start = session_.start_frame(at_ms(ms));
    if (start) session_.on_frame_ready(start->key, at_ms(ms));
    return start && start->is_key_wanted;
  };
  EXPECT_TRUE(wish(2, 10));
  EXPECT_FALSE(wish(3, 20)) << "frame 2 is on its way";
  lost.received = 2;
  EXPECT_TRUE(wish(4, 30)) << "it has come and did not help";
  EXPECT_EQ(session_.counters().keys_wanted, 2U);
}

TEST_F(SessionTest, AFrameThatNeverLeavesIsFollowedByAKeyFrame) {
  see(1, 0);
  const auto start = session_.start_frame(at_ms(1));
  session_.on_frame_abandoned(start->key);
  see(2, 2);
  EXPECT_TRUE(session_.start_frame(at_ms(3))->is_key_wanted);
}

TEST_F(SessionTest, GazesAreFollowedForWhenTheFrameIsSeen) {
  see(1, 0);
  const auto start = session_.start_frame(at_ms(1));
  ASSERT_EQ(start->gazes.size(), 2U);
  EXPECT_EQ(start->gazes[0].radius.value(), SessionRules{}.gaze.base_radius.value());
}

}  // namespace
}  // namespace macula::session
