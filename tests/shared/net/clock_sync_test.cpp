#include "shared/net/clock_sync.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace macula::net {
namespace {

using std::chrono::duration_cast;
using std::chrono::hours;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

/// Two clocks and a link between them; times are those of the client unless said otherwise.
struct Link {
  Nanoseconds offset{0};  ///< server minus client at client time 0
  double skew = 0.0;      ///< the server's clock runs this much faster

  ServerTime server(ClientTime t) const {
    const auto drift =
        static_cast<std::int64_t>(std::llround(double(t.time_since_epoch().count()) * skew));
    return ServerTime{t.time_since_epoch() + offset + Nanoseconds{drift}};
  }
  ClockSync::Sample exchange(ClientTime sent, Nanoseconds up, Nanoseconds service,
                             Nanoseconds down) const {
    return {sent, server(sent + up), server(sent + up + service), sent + up + service + down};
  }
  Nanoseconds true_offset(ClientTime t) const {
    return server(t).time_since_epoch() - t.time_since_epoch();
  }
};

ClientTime at(Nanoseconds t) {
  return ClientTime{t};
}

TEST(ClockSync, KnowsNothingBeforeTheFirstSample) {
  EXPECT_FALSE(ClockSync{}.estimate(at(seconds{1})));
}

// Equal one-way delays cancel exactly: (d + o + o - d) / 2 = o.
TEST(ClockSync, IsExactOnASymmetricLink) {
  const Link link{hours{1} + Nanoseconds{123'457}, 0.0};
  ClockSync sync;
  sync.add(link.exchange(at(seconds{5}), milliseconds{4}, microseconds{50}, milliseconds{4}));
  const auto estimate = sync.estimate(at(seconds{5}));
  ASSERT_TRUE(estimate);
  EXPECT_EQ(estimate->server_minus_client, link.offset);
  EXPECT_EQ(estimate->min_rtt, milliseconds{8});
  EXPECT_EQ(estimate->bound, milliseconds{4});
}

TEST(ClockSync, TranslatesThereAndBack) {
  const ClockEstimate estimate{seconds{-7}, {}, {}};
  EXPECT_EQ(estimate.to_client(estimate.to_server(at(seconds{3}))), at(seconds{3}));
  EXPECT_EQ(estimate.to_server(at(seconds{3})), ServerTime{seconds{-4}});
}

TEST(ClockSync, TheBoundGrowsBy500ppmOfAge) {
  const Link link;
  ClockSync sync;
  sync.add(link.exchange(at(seconds{0}), milliseconds{1}, {}, milliseconds{1}));
  EXPECT_EQ(sync.estimate(at(seconds{2}))->bound, milliseconds{1} + milliseconds{1});
}

/// How often |error| exceeded a bound over many random links, exchanges and moments.
template <class Bound>
int bound_misses(Bound&& bound_of) {
  std::mt19937_64 random(1);
  const auto up_to = [&](std::int64_t ns) {
    return Nanoseconds{static_cast<std::int64_t>(random() % std::uint64_t(ns))};
  };
  int misses = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const double skew = 499e-6 * (2.0 * double(random() % 1001) / 1000.0 - 1.0);
    const Link link{up_to(3'600'000'000'000), skew};
    ClockSync sync;
    ClientTime now = at(seconds{1});
    for (int i = 0; i < 100; ++i) {
      const auto sample =
          link.exchange(now, up_to(80'000'000), up_to(1'000'000), up_to(80'000'000));
      sync.add(sample);
      now = sample.pong_received + up_to(100'000'000);
      const auto estimate = sync.estimate(now);
      const auto error = std::chrono::abs(estimate->server_minus_client - link.true_offset(now));
      misses += error > bound_of(*estimate) ? 1 : 0;
    }
    EXPECT_EQ(sync.resets(), 0);
  }
  return misses;
}

TEST(ClockSync, TheBoundHoldsOnAnyAsymmetricSkewedLink) {
  EXPECT_EQ(bound_misses([](const ClockEstimate& e) { return e.bound; }), 0);
}

// The must-fail twin: a bound of a third of what we promise is broken by asymmetric links.
TEST(ClockSync, AThirdOfTheBoundDoesNotHold) {
  EXPECT_GT(bound_misses([](const ClockEstimate& e) { return e.bound / 3; }), 0);
}

TEST(ClockSync, ASuspendResetsTheEstimate) {
  Link link{seconds{10}, 0.0};
  ClockSync sync;
  for (int i = 0; i < 20; ++i) {
    sync.add(link.exchange(at(milliseconds{100 * i}), milliseconds{3}, {}, milliseconds{3}));
  }
  link.offset += seconds{1};  // the client's clock stood still for a second
  const ClientTime later = at(milliseconds{2000});
  sync.add(link.exchange(later, milliseconds{20}, {}, milliseconds{20}));
  EXPECT_EQ(sync.resets(), 1);
  EXPECT_EQ(sync.estimate(later)->server_minus_client, link.offset);
}

TEST(ClockSync, KeepsTheLowestRoundTrip) {
  const Link link{seconds{1}, 0.0};
  ClockSync sync;
  sync.add(link.exchange(at(milliseconds{0}), milliseconds{1}, {}, milliseconds{1}));
  sync.add(link.exchange(at(milliseconds{100}), milliseconds{90}, {}, milliseconds{1}));
  EXPECT_EQ(sync.estimate(at(milliseconds{300}))->server_minus_client, link.offset);
}

/// Errors in ms of an estimator that hears nothing for ten seconds after half a minute of
/// exchanges.
struct Silence {
  double with_skew_ms = 0.0, without_skew_ms = 0.0;
};
Silence error_after_silence(double skew) {
  std::mt19937_64 random(4);
  const auto up_to = [&](std::int64_t ns) {
    return Nanoseconds{static_cast<std::int64_t>(random() % std::uint64_t(ns))};
  };
  const Link link{seconds{77}, skew};
  ClockSync sync;
  ClientTime now = at(seconds{1});
  Nanoseconds last_best{0};
  for (int i = 0; i < 300; ++i) {
    const Nanoseconds up = milliseconds{4} + up_to(2'000'000),
                      down = milliseconds{4} + up_to(2'000'000);
    sync.add(link.exchange(now, up, microseconds{30}, down));
    last_best = sync.estimate(now)->server_minus_client;
    now += milliseconds{100};
  }
  now += seconds{10};
  const auto estimate = sync.estimate(now);
  EXPECT_LE(std::chrono::abs(estimate->server_minus_client - link.true_offset(now)),
            estimate->bound);
  return {units::to_ms(std::chrono::abs(estimate->server_minus_client - link.true_offset(now))),
          units::to_ms(std::chrono::abs(last_best - link.true_offset(now)))};
}

// 200 ppm over ten silent seconds are 2 ms; the line through half a minute of samples knows them.
TEST(ClockSync, CarriesTheOffsetOnBySkewWhereNoSampleComes) {
  for (const double skew : {-200e-6, 0.0, 200e-6}) {
    const Silence error = error_after_silence(skew);
    EXPECT_LE(error.with_skew_ms, 0.5) << skew;
    if (skew != 0.0) {
      EXPECT_GE(error.without_skew_ms, 1.5) << "the must-fail twin: the last offset held";
    }
  }
}

// Two exchanges that hurried one way each: every one alone leaves 10 ms, together 2 ms.
TEST(ClockSync, WhatAllSamplesAllowIsTighterThanAnyOne) {
  const Link link{seconds{3}, 0.0};
  ClockSync sync;
  sync.add(link.exchange(at(milliseconds{0}), milliseconds{1}, {}, milliseconds{19}));
  sync.add(link.exchange(at(milliseconds{30}), milliseconds{19}, {}, milliseconds{1}));
  const auto estimate = sync.estimate(at(milliseconds{60}));
  EXPECT_LE(estimate->bound, milliseconds{3});
  EXPECT_LE(std::chrono::abs(estimate->server_minus_client - link.offset), estimate->bound);
}

// A minute of a full link: Pings take 60 ms, all of it one way. The quick ones before it are still
// the better guide, and the round trip they had is the link's.
TEST(ClockSync, AFullLinkDoesNotDragTheEstimateAlong) {
  const Link link{seconds{5}, 0.0};
  ClockSync sync;
  for (int i = 0; i < 100; ++i) {
    sync.add(link.exchange(at(milliseconds{100 * i}), milliseconds{4}, {}, milliseconds{4}));
  }
  for (int i = 100; i < 550; ++i) {
    sync.add(link.exchange(at(milliseconds{100 * i}), milliseconds{4}, {}, milliseconds{56}));
  }
  const auto estimate = sync.estimate(at(seconds{55}));
  const auto error = std::chrono::abs(estimate->server_minus_client - link.offset);
  EXPECT_LE(error, microseconds{500});
  EXPECT_LE(error, estimate->bound);
  EXPECT_EQ(estimate->min_rtt, milliseconds{8});
}

TEST(ClockSync, ImpossibleSamplesAreRefusedAndCounted) {
  ClockSync sync;
  const ServerTime t{seconds{9}};
  sync.add({at(milliseconds{10}), t, t, at(milliseconds{5})});  // negative RTT
  sync.add(
      {at(milliseconds{10}), t, t - milliseconds{1}, at(milliseconds{20})});  // negative service
  sync.add({at(milliseconds{10}), t, t + milliseconds{30}, at(milliseconds{20})});
  EXPECT_EQ(sync.refused(), 3);
  EXPECT_FALSE(sync.estimate(at(seconds{1})));
}

}  // namespace
}  // namespace macula::net
