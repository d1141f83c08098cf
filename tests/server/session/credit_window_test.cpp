#include "server/session/credit_window.h"

#include <gtest/gtest.h>

#include "tests/server/session/session_fixtures.h"

namespace macula::session {
namespace {

using test::at_ms;

net::Acks received(std::uint64_t frame) {
  net::Acks acks;
  acks.received = frame;
  return acks;
}

net::Acks receiving(std::uint64_t frame, std::uint64_t bytes) {
  net::Acks acks;
  acks.receiving = frame;
  acks.receiving_bytes = bytes;
  return acks;
}

std::uint64_t send_one(CreditWindow& credit, double ms) {
  const std::uint64_t frame = credit.start();
  credit.hand_over(frame, at_ms(ms));
  return frame;
}

TEST(CreditWindow, FrameIdsCountFromOne) {
  CreditWindow credit{SessionRules{}};
  EXPECT_EQ(credit.start(), 1U);
  EXPECT_EQ(credit.start(), 2U);
}

TEST(CreditWindow, HoldsTwoFramesInFlightAndOneMoreUnsentBeforeAnyRoundTripIsKnown) {
  CreditWindow credit{SessionRules{}};
  send_one(credit, 0);
  EXPECT_TRUE(credit.may_send(at_ms(0)));
  send_one(credit, 1);
  EXPECT_FALSE(credit.may_send(at_ms(1)));
  ASSERT_TRUE(credit.may_start(at_ms(1)));
  credit.start();
  EXPECT_FALSE(credit.may_start(at_ms(1)));
}

TEST(CreditWindow, NeverHasMoreThanTwoFramesUnsent) {
  CreditWindow credit{SessionRules{}};
  credit.start();
  ASSERT_TRUE(credit.may_start(at_ms(0)));
  credit.start();
  EXPECT_FALSE(credit.may_start(at_ms(0)));
}

TEST(CreditWindow, AnAcknowledgementReturnsTheCreditOfEveryFrameUpToIt) {
  CreditWindow credit{SessionRules{}};
  send_one(credit, 0);
  send_one(credit, 1);
  EXPECT_EQ(credit.acknowledge(received(2), at_ms(5)), AckVerdict::Taken);
  EXPECT_EQ(credit.in_flight(), 0);
}

TEST(CreditWindow, RefusesAcknowledgementsAboveTheLastSentFrame) {
  CreditWindow credit{SessionRules{}};
  send_one(credit, 0);
  credit.start();  // frame 2 is unsent: nobody can have received it
  EXPECT_EQ(credit.acknowledge(received(2), at_ms(5)), AckVerdict::AboveLastSent);
  EXPECT_EQ(credit.acknowledge(receiving(2, 10), at_ms(5)), AckVerdict::AboveLastSent);
  EXPECT_EQ(credit.in_flight(), 1);
}

TEST(CreditWindow, ARepeatedAcknowledgementChangesNothing) {
  CreditWindow credit{SessionRules{}};
  send_one(credit, 0);
  credit.acknowledge(received(1), at_ms(5));
  send_one(credit, 6);
  EXPECT_EQ(credit.acknowledge(received(1), at_ms(7)), AckVerdict::Repeated);
  EXPECT_EQ(credit.in_flight(), 1);
}

// 20 frames at 50 Hz, each acknowledged 70 ms after its last byte: rate x RTT = 3.5, so the window
// is ceil(3.5) + 1 = 5.
TEST(CreditWindow, GrowsWithRateTimesLeastRoundTrip) {
  CreditWindow credit{SessionRules{}};
  for (int i = 0; i < 20; ++i) {
    const double sent = 20.0 * i;
    const std::uint64_t frame = send_one(credit, sent);
    credit.on_sent(frame, at_ms(sent));
    if (i >= 4) credit.acknowledge(received(frame - 3), at_ms(20.0 * (i - 3) + 70.0));
  }
  EXPECT_EQ(credit.window(at_ms(380)), 5);
}

TEST(CreditWindow, NeverLeavesTwoToSix) {
  CreditWindow fast{SessionRules{}}, slow{SessionRules{}};
  for (int i = 0; i < 10; ++i) {
    const double sent = 10.0 * i;
    const std::uint64_t a = send_one(fast, sent), b = send_one(slow, sent);
    fast.on_sent(a, at_ms(sent));
    slow.on_sent(b, at_ms(sent));
    fast.acknowledge(received(a), at_ms(sent + 0.1));
    if (i == 9) slow.acknowledge(received(b), at_ms(sent + 900.0));
  }
  EXPECT_EQ(fast.window(at_ms(100)), 2);
  EXPECT_EQ(slow.window(at_ms(100)), 6);
}

TEST(CreditWindow, AFrameWithoutProgressForASecondIsLostAndReturnsItsCredit) {
  CreditWindow credit{SessionRules{}};
  send_one(credit, 0);
  EXPECT_EQ(credit.expire(at_ms(1000)), 0);
  EXPECT_EQ(credit.expire(at_ms(1001)), 1);
  EXPECT_EQ(credit.in_flight(), 0);
}

// A 400 kB frame over 2 Mbit/s takes 1.6 s: it is not lost as long as its bytes keep arriving.
TEST(CreditWindow, ReceivingProgressKeepsASlowFrameAlive) {
  CreditWindow credit{SessionRules{}};
  send_one(credit, 0);
  for (int step = 1; step <= 6; ++step)
    credit.acknowledge(receiving(1, 65536U * static_cast<unsigned>(step)), at_ms(260.0 * step));
  EXPECT_EQ(credit.expire(at_ms(1600)), 0);
  EXPECT_EQ(credit.in_flight(), 1);
  // The same report again and again is no progress.
  for (int step = 1; step <= 6; ++step)
    credit.acknowledge(receiving(1, 65536U * 6U), at_ms(1560.0 + 260.0 * step));
  EXPECT_EQ(credit.expire(at_ms(2600)), 1);
}

TEST(CreditWindow, AnAcknowledgementAfterTheLossIsHarmless) {
  CreditWindow credit{SessionRules{}};
  send_one(credit, 0);
  credit.expire(at_ms(2000));
  EXPECT_EQ(credit.acknowledge(received(1), at_ms(2001)), AckVerdict::Taken);
  EXPECT_EQ(credit.in_flight(), 0);
}

// RTT 400 ms: 4 x RTT = 1.6 s replaces the least time-out of 1 s.
TEST(CreditWindow, WaitsFourRoundTripsWhereThatIsLonger) {
  CreditWindow credit{SessionRules{}};
  credit.on_sent(send_one(credit, 0), at_ms(0));
  credit.acknowledge(received(1), at_ms(400));
  send_one(credit, 1000);
  EXPECT_EQ(credit.expire(at_ms(2590)), 0);
  EXPECT_EQ(credit.expire(at_ms(2601)), 1);
}

// Found by simulation: an acknowledgement held back by 0.9 s of silence counted as the round trip,
// and the next lost frame kept its credit for 3.4 s.
TEST(CreditWindow, ALateAcknowledgementDoesNotStretchTheLossTimeout) {
  CreditWindow credit{SessionRules{}};
  credit.on_sent(send_one(credit, 0), at_ms(0));
  credit.acknowledge(received(1), at_ms(10));
  credit.on_sent(send_one(credit, 20), at_ms(20));
  credit.acknowledge(received(2), at_ms(920));
  send_one(credit, 930);
  EXPECT_EQ(credit.expire(at_ms(1931)), 1);
}

TEST(CreditWindow, RoundTripIsMeasuredEvenWhenTheAcknowledgementOvertakesTheSendReport) {
  CreditWindow credit{SessionRules{}};
  const std::uint64_t frame = send_one(credit, 0);
  credit.acknowledge(received(frame), at_ms(12));
  credit.on_sent(frame, at_ms(2));
  EXPECT_EQ(credit.rtt().least(at_ms(12)), std::chrono::milliseconds{10});
}

/// A server stopped for a minute with a frame in flight took that minute for a round trip; when the
/// frames after it were lost, their credit came back four minutes later (seed 3066 of the
/// simulation).
TEST(CreditWindow, APauseOfTheMachineIsNoRoundTrip) {
  CreditWindow credit{SessionRules{}};
  const std::uint64_t frame = send_one(credit, 0);
  credit.on_sent(frame, at_ms(1));
  credit.acknowledge(received(frame), at_ms(60'000));
  EXPECT_EQ(credit.rtt().least(at_ms(60'000)), std::nullopt);
  send_one(credit, 60'001);
  send_one(credit, 60'002);
  EXPECT_FALSE(credit.may_send(at_ms(60'500)));
  EXPECT_EQ(credit.expire(at_ms(61'100)), 2);
}

TEST(RttWindow, ForgetsItsLeastSampleAfterTenSeconds) {
  RttWindow rtt;
  rtt.add(std::chrono::milliseconds{5}, at_ms(0));
  rtt.add(std::chrono::milliseconds{9}, at_ms(6000));
  EXPECT_EQ(rtt.least(at_ms(9000)), std::chrono::milliseconds{5});
  EXPECT_EQ(rtt.least(at_ms(10001)), std::chrono::milliseconds{9});
  EXPECT_EQ(rtt.least(at_ms(17000)), std::nullopt);
}

// Frames of a full link take 60 ms from their last byte to their acknowledgement, for those before
// them stand in the way; the link itself takes 8.
TEST(CreditWindow, AFullLinkIsNotFilledFurtherForTheQueueItHas) {
  const auto window_after = [](double ping_ms) {
    CreditWindow credit{SessionRules{}};
    for (std::uint64_t frame = 1; frame <= 20; ++frame) {
      const double ms = 20.0 * static_cast<double>(frame);
      credit.start();
      credit.hand_over(frame, at_ms(ms));
      credit.on_sent(frame, at_ms(ms + 1.0));
      net::Acks acks;
      acks.received = frame;
      acks.least_rtt = units::from_ms(ping_ms);
      credit.acknowledge(acks, at_ms(ms + 61.0));
    }
    return credit.window(at_ms(461.0));
  };
  EXPECT_EQ(window_after(0.0), 4) << "nothing is known of Pings: 50 a second x 60 ms, and one";
  EXPECT_EQ(window_after(8.0), 2);
}

}  // namespace
}  // namespace macula::session
