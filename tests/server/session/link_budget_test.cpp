// The link's estimate and the byte budget, against a link of known rate in virtual time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>

#include "server/session/byte_budget.h"
#include "server/session/governor.h"
#include "server/session/link_estimate.h"
#include "tests/server/session/session_fixtures.h"

namespace macula::session {
namespace {

using namespace std::chrono_literals;
using test::at_ms;

constexpr double kMbit = 1e6 / 8.0;

/// Carries one frame after the other at `bytes_per_s` and answers `one_way` later.
struct Pipe {
  double bytes_per_s = 1e6, one_way_ms = 4.0;
  double free_ms = 0.0;

  double acknowledged_ms(double sent_ms, double bytes) {
    free_ms = std::max(free_ms, sent_ms + one_way_ms) + 1e3 * bytes / bytes_per_s;
    return free_ms + one_way_ms;
  }
};

net::Acks acks(std::uint64_t received, double rtt_ms) {
  net::Acks acks;
  acks.received = received;
  acks.least_rtt = units::from_ms(rtt_ms);
  return acks;
}

/// What is estimated after 20 frames of `bytes`, one every `every_ms`.
double estimated(Pipe pipe, double bytes, double every_ms) {
  LinkEstimate link;
  for (std::uint64_t frame = 1; frame <= 20; ++frame) {
    const double sent_ms = every_ms * static_cast<double>(frame);
    link.on_handed_over(frame, static_cast<std::size_t>(bytes), at_ms(sent_ms));
    link.on_acks(acks(frame, 2.0 * pipe.one_way_ms), at_ms(pipe.acknowledged_ms(sent_ms, bytes)));
  }
  return *link.bytes_per_s();
}

TEST(LinkEstimate, KnowsNothingBeforeAnAcknowledgement) {
  LinkEstimate link;
  link.on_handed_over(1, 1000, at_ms(0));
  EXPECT_FALSE(link.bytes_per_s());
}

// Whether the link waits for frames or frames for the link, and however long it is.
TEST(LinkEstimate, FindsTheRateOfIdleAndBusyLinks) {
  for (const double mbit : {2.0, 10.0, 30.0, 100.0}) {
    for (const double one_way_ms : {0.5, 4.0, 40.0}) {
      const Pipe pipe{mbit * kMbit, one_way_ms};
      const double bytes = 20e3, service_ms = 1e3 * bytes / pipe.bytes_per_s;
      EXPECT_NEAR(estimated(pipe, bytes, 3.0 * service_ms) / pipe.bytes_per_s, 1.0, 0.02)
          << mbit << " idle " << one_way_ms;
      EXPECT_NEAR(estimated(pipe, bytes, 0.7 * service_ms) / pipe.bytes_per_s, 1.0, 0.02)
          << mbit << " busy " << one_way_ms;
    }
  }
}

// The must-fail twin: without the round trip of Pings a long idle link looks slow.
TEST(LinkEstimate, WithoutThePingsRoundTripAnIdleLinkLooksSlow) {
  LinkEstimate link;
  Pipe pipe{100 * kMbit, 40.0};
  for (std::uint64_t frame = 1; frame <= 20; ++frame) {
    const double sent_ms = 100.0 * static_cast<double>(frame);
    link.on_handed_over(frame, 20'000, at_ms(sent_ms));
    link.on_acks(acks(frame, 0.0), at_ms(pipe.acknowledged_ms(sent_ms, 20e3)));
  }
  EXPECT_LT(*link.bytes_per_s(), 0.1 * pipe.bytes_per_s);
}

TEST(LinkEstimate, AFrameStuckOnItsWayCountsBeforeItIsThrough) {
  LinkEstimate link;
  Pipe pipe{100 * kMbit, 4.0};
  for (std::uint64_t frame = 1; frame <= 20; ++frame) {
    const double sent_ms = 20.0 * static_cast<double>(frame);
    link.on_handed_over(frame, 20'000, at_ms(sent_ms));
    link.on_acks(acks(frame, 8.0), at_ms(pipe.acknowledged_ms(sent_ms, 20e3)));
  }
  link.on_handed_over(21, 60'000, at_ms(500));
  net::Acks progress = acks(20, 8.0);
  progress.receiving = 21;
  progress.receiving_bytes = 12'500;  // 2 Mbit/s
  link.on_acks(progress, at_ms(558));
  EXPECT_LT(*link.bytes_per_s(), 40 * kMbit);
}

/// A session's frames over a pipe in virtual time: planned, made in 15 ms, sent, acknowledged;
/// never more than two on their way. Colour takes the bytes it is given, up to 60 kB.
class Play {
 public:
  explicit Play(std::optional<Nanoseconds> goal) : governor_(Goals{std::nullopt, goal}) {}

  /// Ages of the frames shown until `until_ms`, from reading the pose to the display.
  std::vector<double> run(double until_ms) {
    std::vector<double> ages;
    while (now_ms_ < until_ms) {
      const double start_ms = std::max(now_ms_, next_start_ms_);
      while (!acks_.empty() && (acks_.front().at_ms <= start_ms || acks_.size() >= 2)) take_ack();
      const double begin_ms = std::max(start_ms, last_ack_ms_blocking_);
      const Quality quality = governor_.plan(
          {link_.bytes_per_s(), units::from_ms(2.0 * pipe.one_way_ms), units::from_ms(14.0)},
          at_ms(begin_ms));
      const double depth = 12e3 / std::pow(3.0, std::log2(quality.bytes.depth_divisor));
      const double wanted = 60e3 * quality.scale * quality.scale;
      const double color = quality.bytes.color_bytes == 0
                               ? wanted
                               : std::min(wanted, static_cast<double>(quality.bytes.color_bytes));
      EncodedSize size{static_cast<std::size_t>(color), static_cast<std::size_t>(depth),
                       static_cast<std::size_t>(6e5 * quality.scale * quality.scale),
                       quality.bytes.depth_divisor, units::from_ms(15.0)};
      governor_.on_encoded(size);
      const double ready_ms = begin_ms + 15.0;
      link_.on_handed_over(++frame_, size.bytes(), at_ms(ready_ms));
      const double acked_ms = pipe.acknowledged_ms(ready_ms, color + depth);
      acks_.push_back({frame_, acked_ms});
      ages.push_back(acked_ms - pipe.one_way_ms + 14.0 - (begin_ms - pipe.one_way_ms));
      next_start_ms_ = begin_ms + std::max(units::to_ms(quality.bytes.least_interval), 1e3 / 72.0);
      now_ms_ = begin_ms;
      last_quality = quality;
      last_bytes = color + depth;
    }
    return ages;
  }
  double now_ms() const { return now_ms_; }

  Pipe pipe{100 * kMbit, 4.0};
  Quality last_quality;
  double last_bytes = 0.0;

 private:
  struct Ack {
    std::uint64_t frame = 0;
    double at_ms = 0.0;
  };
  void take_ack() {
    const Ack ack = acks_.front();
    acks_.pop_front();
    link_.on_acks(acks(ack.frame, 2.0 * pipe.one_way_ms), at_ms(ack.at_ms));
    last_ack_ms_blocking_ = ack.at_ms;
  }

  Governor governor_;
  LinkEstimate link_;
  std::deque<Ack> acks_;
  std::uint64_t frame_ = 0;
  double now_ms_ = 0.0, next_start_ms_ = 0.0, last_ack_ms_blocking_ = 0.0;
};

double p95(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() * 95 / 100];
}

TEST(ByteBudget, AFastLinkGetsAllItsBytes) {
  Play play(100ms);
  play.run(3000);
  EXPECT_NEAR(play.last_bytes, 72e3, 1e3);
  EXPECT_EQ(play.last_quality.bytes.depth_divisor, 1);
  EXPECT_EQ(play.last_quality.scale, 1.0);
}

// What a frame may take and does not must not hold the next one up.
TEST(ByteBudget, SmallFramesOnAFastLinkComeAtTheDisplaysRate) {
  ByteBudget budget(100ms);
  budget.on_encoded({4000, 1000, 100'000, 1, units::from_ms(10.0)});
  const BytePlan plan =
      budget.plan({100 * kMbit, units::from_ms(8.0), units::from_ms(14.0)}, at_ms(0));
  EXPECT_LT(plan.least_interval, units::from_ms(1.0));
}

// A busy machine acknowledges late: of small frames that looks like a slow link.
double bytes_after_a_while(Nanoseconds work) {
  constexpr double kLink = 100 * kMbit, kLate_s = 8e-3;
  ByteBudget budget(100ms);
  double bytes = 5000.0;
  for (int frame = 0; frame < 100; ++frame) {
    const auto size = static_cast<std::size_t>(bytes);
    budget.on_encoded({size, size / 10, 100'000, 1, work});
    const double seems = bytes / (kLate_s + bytes / kLink);
    const BytePlan plan =
        budget.plan({seems, units::from_ms(1.0), units::from_ms(30.0)}, at_ms(250.0 * frame));
    bytes = static_cast<double>(plan.color_bytes);
  }
  return bytes;
}
TEST(ByteBudget, AServerSlowerThanTheGoalStillUsesAFastLink) {
  EXPECT_GT(bytes_after_a_while(250ms), 150e3);
  EXPECT_LT(bytes_after_a_while(65ms), 10e3) << "twin: five milliseconds of what seems slow";
}

TEST(ByteBudget, FromAHundredToTwoMbitAgesStayWithinTwiceTheGoalAndRecover) {
  Play play(100ms);
  play.run(5000);
  play.pipe.bytes_per_s = 2 * kMbit;
  play.run(7000);
  EXPECT_LE(p95(play.run(15000)), 200.0);
  EXPECT_GT(play.last_quality.bytes.depth_divisor, 1);
  play.pipe.bytes_per_s = 100 * kMbit;
  play.run(20000);
  EXPECT_LE(p95(play.run(22000)), 100.0);
  EXPECT_GT(play.last_bytes, 40e3);
}

// The must-fail twin.
TEST(ByteBudget, WithoutAGoalAgesOnASlowLinkAreFarBeyondIt) {
  Play play(std::nullopt);
  play.run(5000);
  play.pipe.bytes_per_s = 2 * kMbit;
  play.run(7000);
  EXPECT_GT(p95(play.run(15000)), 400.0);
}

TEST(ByteBudget, ResolutionGivesWayLastAndAtMostEveryTwoSeconds) {
  Play play(100ms);
  play.run(5000);
  play.pipe.bytes_per_s = 1 * kMbit;
  double scale = 1.0, changed_ms = -1e9;
  while (play.now_ms() < 30000) {
    play.run(play.now_ms() + 1.0);
    if (play.last_quality.scale == scale) continue;
    EXPECT_GE(play.now_ms() - changed_ms, 2000.0);
    EXPECT_GT(play.last_quality.bytes.depth_divisor, 1) << "depth goes first";
    scale = play.last_quality.scale;
    changed_ms = play.now_ms();
  }
  EXPECT_LT(scale, 1.0);
}

TEST(Governor, ALinkThatLosesTooManyFramesGetsColourThatLeansOnNone) {
  Governor governor;
  for (int i = 0; i < 4; ++i) governor.on_key_wanted(at_ms(100.0 * i));
  EXPECT_EQ(governor.plan({}, at_ms(400)).color, Quality::Color::Stateless);
  EXPECT_EQ(governor.plan({}, at_ms(11000)).color, Quality::Color::AsAgreed);
}

TEST(Governor, AFewLossesFarApartChangeNothing) {
  Governor governor;
  for (int i = 0; i < 10; ++i) governor.on_key_wanted(at_ms(3000.0 * i));
  EXPECT_EQ(governor.plan({}, at_ms(30000)).color, Quality::Color::AsAgreed);
}

}  // namespace
}  // namespace macula::session
