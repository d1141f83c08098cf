// Links that lose, damage, narrow and part, between a whole server and a viewer.
#include <cmath>
#include <thread>

#include "tests/faults/faults_fixture.h"
#include "tests/support/chaos_proxy.h"

namespace macula::faults {
namespace {

using support::ChaosProxy;
using support::Direction;

class LinkFaults : public testing::Test {
 protected:
  /// A server with an injected render time and a viewer behind a proxy.
  void begin(std::chrono::milliseconds render, std::optional<Nanoseconds> age_goal = {}) {
    loopback::LoopbackServerOptions options;
    options.delays.render = render;
    options.age_goal = age_goal;
    server_ = std::make_unique<LoopbackServer>(keys_.path(), options);
    proxy_ = *ChaosProxy::create((*server_)->endpoint(), 7);
    viewer_ = std::make_unique<EndpointClient>(proxy_->endpoint(), keys_.path(),
                                               (*server_)->public_key_z85());
    ASSERT_TRUE(viewer_->step_until_frames(10));
  }
  void shape(const support::LinkShape& shape) {
    for (const Direction way : {Direction::ToServer, Direction::ToClient})
      proxy_->shape(way, shape);
  }
  /// Ages of the frames that come in a while: from the head pose they show to their last byte, ms.
  std::vector<double> ages(std::chrono::milliseconds span) {
    const std::size_t before = viewer_->frames().size();
    for (const auto start = Clock::now(); Clock::now() - start < span;) viewer_->step(4ms);
    std::vector<double> ages_ms;
    for (std::size_t i = before; i < viewer_->frames().size(); ++i) {
      const net::ReceivedFrame& frame = viewer_->frames()[i];
      ages_ms.push_back(units::to_ms(frame.last_byte - frame.begin.view_sampled));
    }
    return ages_ms;
  }

  TemporaryFolder keys_;
  std::unique_ptr<LoopbackServer> server_;
  std::unique_ptr<ChaosProxy> proxy_;
  std::unique_ptr<EndpointClient> viewer_;
};

/// The chance at which a packet must be lost so that a frame of so many bytes loses one.
double packet_loss(double frame_loss, double frame_bytes) {
  constexpr double kPacketBytes = 1448.0;  // what the proxy's losses are drawn for
  return 1.0 - std::pow(1.0 - frame_loss, 1.0 / std::ceil(frame_bytes / kPacketBytes));
}

double bytes_of(const net::ReceivedFrame& frame) {
  double bytes = 0.0;
  for (const auto& payload : frame.payloads) bytes += static_cast<double>(payload.size());
  return bytes;
}

/// TCP shows a loss as a stall of a round trip (fast retransmission).
TEST_F(LinkFaults, ALostFrameCostsARoundTripAndAFrameAndNothingGrows) {
  constexpr double kFrame_ms = 20.0, kRoundTrip_ms = 20.0;
  begin(20ms);
  const auto span = times(1, 20) * 3000ms;
  support::LinkShape link{.delay = 10ms};
  shape(link);
  ages(500ms);
  const double normal = quantile(ages(span), 0.99);
  for (const double loss : {0.01, 0.05, 0.2}) {
    link.loss = packet_loss(loss, bytes_of(viewer_->frames().back()));
    link.loss_stall = 20ms;
    proxy_->shape(Direction::ToClient, link);
    double early = 0.0, late = 0.0;
    const double allowed = normal + kRoundTrip_ms + kFrame_ms;
    const double p99 = least_of(3, allowed, [&] {
      early = quantile(ages(span / 2), 0.5);
      const auto rest = ages(span / 2);
      late = quantile(rest, 0.5);
      return quantile(rest, 0.99);
    });
    EXPECT_LE(p99, allowed) << loss;
    EXPECT_LE(late, early + kFrame_ms) << loss;
    note_fault(
        text("frame loss ", 100.0 * loss, " %"),
        "age p99 <= normal + 1 round trip + 1 frame, no growth",
        text("p99 ", p99, " ms, normal ", normal, " ms; medians ", early, " then ", late, " ms in ",
             1e-3 * std::chrono::duration<double, std::milli>(span).count(), " s"));
  }
}

TEST_F(LinkFaults, AnOutageOf200msIsOverWithinASecond) {
  begin(5ms);
  std::vector<double> recoveries;
  const int outages = times(3, 50);
  for (int i = 0; i < outages; ++i) {
    for (const Direction way : {Direction::ToServer, Direction::ToClient}) proxy_->stall(way);
    ages(200ms);
    for (const Direction way : {Direction::ToServer, Direction::ToClient}) proxy_->resume(way);
    const auto up = Clock::now();
    // Of a view from after the outage: what was on its way does not count.
    const std::uint64_t sequence = viewer_->next_view().sequence;
    ASSERT_TRUE(viewer_->step_until(
        [&] { return viewer_->frames().back().begin.view_sequence > sequence; }));
    recoveries.push_back(ms_since(up));
    ages(100ms);
  }
  EXPECT_LE(quantile(recoveries, 0.5), 1000.0);
  EXPECT_TRUE(kept_its_session(*viewer_));
  note_fault("200 ms partition", "recovered <= 1 s after the link is up",
             text("median ", quantile(recoveries, 0.5), " ms, longest of ", outages, " ",
                  quantile(recoveries, 1.0), " ms"));
}

TEST_F(LinkFaults, ASlowReaderIsNeverOwedMoreThanItsWindow) {
  begin(0ms);
  int most_unsent = 0, most_in_flight = 0;
  const auto start = Clock::now();
  auto next_read = start;
  while (Clock::now() - start < times(1, 10) * 3000ms) {
    viewer_->endpoint().publish(viewer_->next_view());
    if (Clock::now() >= next_read) {  // one frame a second, late as they may be
      viewer_->take(0ms);
      next_read += 1s;
    }
    std::this_thread::sleep_for(4ms);
    for (const session::SessionState& now : (*server_)->telemetry().now) {
      most_unsent = std::max(most_unsent, now.unsent);
      most_in_flight = std::max(most_in_flight, now.in_flight);
    }
  }
  EXPECT_LE(most_unsent, 2);
  EXPECT_LE(most_in_flight, 6);
  note_fault("slow client (1 frame a second)", "queue <= 2 frames",
             text("most unsent ", most_unsent, ", in flight ", most_in_flight));
}

TEST_F(LinkFaults, FromAHundredToTwoMbitAgesStayWithinTwiceTheirGoal) {
  constexpr double kGoal_ms = 100.0;
  begin(5ms, units::from_ms(kGoal_ms));
  shape({.delay = 5ms, .bytes_per_s = 12.5e6});
  ages(2000ms);
  double narrow_p95 = 0.0, recovery_ms = 0.0;
  const double excess = least_of(3, 0.0, [&] {
    shape({.delay = 5ms, .bytes_per_s = 250e3, .buffer_bytes = 16384});
    ages(2000ms);
    narrow_p95 = quantile(ages(2000ms), 0.95);
    shape({.delay = 5ms, .bytes_per_s = 12.5e6});
    const auto wide = Clock::now();
    while (quantile(ages(200ms), 0.5) > kGoal_ms && Clock::now() - wide < 10s) {
    }
    recovery_ms = ms_since(wide);
    return std::max({0.0, narrow_p95 - 2.0 * kGoal_ms, recovery_ms - 5000.0});
  });
  EXPECT_LE(excess, 0.0);
  note_fault("100 -> 2 -> 100 Mbit/s", "age p95 <= 2 x goal (100 ms) after 2 s, recovered <= 5 s",
             text("p95 ", narrow_p95, " ms at 2 Mbit/s, recovered after ", recovery_ms, " ms"));
}

}  // namespace
}  // namespace macula::faults
