#include "server/session/head_forecast.h"

#include <gtest/gtest.h>

#include "server/session/session.h"
#include "tests/server/session/session_fixtures.h"

namespace macula::session {
namespace {

using test::at_ms;

SessionRules predicting() {
  SessionRules rules;
  rules.longest_horizon = units::from_ms(100.0);
  rules.most_guard_band = Degrees{15.0};
  return rules;
}

/// A head that turns by `turn_per_s` about the vertical and walks 0.5 m/s to the right, read every
/// 14 ms and shown 10 ms later.
net::ViewState moving(std::uint64_t sequence, Degrees turn_per_s) {
  net::ViewState view = test::view(sequence);
  const double s = 0.014 * static_cast<double>(sequence);
  view.sampled = ClientTime{units::from_s(s)};
  view.predicted_display = view.sampled + units::from_ms(10.0);
  view.stage_from_head = {DVec3{0.5 * s, 1.6, 0.0},
                          glm::angleAxis(Radians{turn_per_s}.value() * s, DVec3{0, 1, 0})};
  return view;
}

/// Frames one after the other, each acknowledged `latency_ms` after its view arrived.
HeadForecast fed(const SessionRules& rules, Degrees turn_per_s, double latency_ms,
                 int frames = 20) {
  HeadForecast forecast(rules);
  for (int i = 1; i <= frames; ++i) {
    const auto frame = static_cast<std::uint64_t>(i);
    forecast.add(moving(frame, turn_per_s));
    forecast.on_started(frame, at_ms(14.0 * i));
    forecast.on_received(frame, at_ms(14.0 * i + latency_ms));
  }
  return forecast;
}

TEST(HeadForecast, CarriesTheHeadOnByWhatFramesTakeAndTheClientNeeds) {
  const HeadForecast forecast = fed(predicting(), Degrees{60.0}, 40.0);
  const net::ViewState now = moving(20, Degrees{60.0});
  EXPECT_EQ(forecast.horizon(now), units::from_ms(50.0));
  const Pose ahead = forecast.stage_from_head(now);
  EXPECT_NEAR(Degrees{math::angle_between(ahead, now.stage_from_head)}.value(), 3.0, 1e-6);
  EXPECT_NEAR(ahead.position.x - now.stage_from_head.position.x, 0.025, 1e-9);
}

TEST(HeadForecast, KnowsNothingBeforeTheFirstAcknowledgement) {
  HeadForecast forecast(predicting());
  const net::ViewState view = moving(1, Degrees{60.0});
  forecast.add(view);
  forecast.on_started(1, at_ms(14));
  EXPECT_EQ(forecast.horizon(view), Nanoseconds{0});
  EXPECT_EQ(forecast.stage_from_head(view).rotation, view.stage_from_head.rotation);
  forecast.on_received(7, at_ms(20));  // a frame nobody started here
  EXPECT_FALSE(forecast.latency());
}

TEST(HeadForecast, LooksNoFurtherAheadThanAllowed) {
  const HeadForecast slow = fed(predicting(), Degrees{60.0}, 400.0);
  EXPECT_EQ(slow.horizon(moving(20, Degrees{60.0})), units::from_ms(100.0));
  const HeadForecast off = fed(SessionRules{}, Degrees{60.0}, 40.0);
  EXPECT_EQ(off.horizon(moving(20, Degrees{60.0})), Nanoseconds{0});
  EXPECT_EQ(off.stage_from_head(moving(20, Degrees{60.0})).position,
            moving(20, Degrees{60.0}).stage_from_head.position);
}

TEST(HeadForecast, FollowsALatencyThatChanges) {
  HeadForecast forecast = fed(predicting(), Degrees{0.0}, 20.0);
  for (std::uint64_t frame = 21; frame < 60; ++frame) {
    const double ms = 14.0 * static_cast<double>(frame);
    forecast.add(moving(frame, Degrees{0.0}));
    forecast.on_started(frame, at_ms(ms));
    forecast.on_received(frame, at_ms(ms + 60.0));
  }
  EXPECT_NEAR(units::to_ms(*forecast.latency()), 60.0, 0.1);
}

TEST(HeadForecast, TheGuardBandCoversTheTurnInWholeStepsUpToItsMost) {
  HeadForecast still = fed(predicting(), Degrees{0.0}, 40.0);
  EXPECT_EQ(still.guard_band(moving(20, Degrees{0.0}), at_ms(300)).value(), 0.0);
  HeadForecast turning = fed(predicting(), Degrees{60.0}, 40.0);  // 3 degrees in 50 ms
  EXPECT_EQ(turning.guard_band(moving(20, Degrees{60.0}), at_ms(300)).value(), 4.0);
  HeadForecast late = fed(predicting(), Degrees{150.0}, 300.0);
  EXPECT_EQ(late.guard_band(moving(20, Degrees{150.0}), at_ms(300)).value(), 15.0);
  HeadForecast off = fed(SessionRules{}, Degrees{60.0}, 40.0);
  EXPECT_EQ(off.guard_band(moving(20, Degrees{60.0}), at_ms(300)).value(), 0.0);
}

TEST(HeadForecast, TheGuardBandFallsSlowlyWhenTheHeadComesToRest) {
  HeadForecast forecast = fed(predicting(), Degrees{60.0}, 40.0);
  EXPECT_EQ(forecast.guard_band(moving(20, Degrees{60.0}), at_ms(300)).value(), 4.0);
  net::ViewState resting = moving(21, Degrees{60.0});
  for (std::uint64_t i = 21; i < 26; ++i) {
    resting.sampled = ClientTime{units::from_s(0.014 * static_cast<double>(i))};
    resting.predicted_display = resting.sampled + units::from_ms(10.0);
    forecast.add(resting);
  }
  EXPECT_EQ(forecast.guard_band(resting, at_ms(400)).value(), 4.0);
  EXPECT_EQ(forecast.guard_band(resting, at_ms(1400)).value(), 2.0);
}

SessionRules layering() {
  SessionRules rules = predicting();
  rules.most_view_cell_m = 0.05;
  return rules;
}

TEST(HeadForecast, TheViewCellIsWhatTheHeadWalksMeanwhileWithinItsBounds) {
  HeadForecast walking = fed(layering(), Degrees{0.0}, 40.0);  // 0.5 m/s over 50 ms
  EXPECT_NEAR(walking.view_cell_m(moving(20, Degrees{0.0}), at_ms(300)), 0.025, 1e-9);
  HeadForecast late = fed(layering(), Degrees{0.0}, 300.0);
  EXPECT_DOUBLE_EQ(late.view_cell_m(moving(20, Degrees{0.0}), at_ms(300)), 0.05);
  HeadForecast quick = fed(layering(), Degrees{0.0}, 1.0);
  EXPECT_DOUBLE_EQ(quick.view_cell_m(moving(20, Degrees{0.0}), at_ms(300)), 0.01);
}

TEST(HeadForecast, ThereIsNoViewCellWithoutAHorizonOrAWish) {
  HeadForecast unwanted = fed(predicting(), Degrees{0.0}, 40.0);
  EXPECT_EQ(unwanted.view_cell_m(moving(20, Degrees{0.0}), at_ms(300)), 0.0);
  SessionRules rules = layering();
  rules.longest_horizon = Nanoseconds{0};
  HeadForecast unpredicted = fed(rules, Degrees{0.0}, 40.0);
  EXPECT_EQ(unpredicted.view_cell_m(moving(20, Degrees{0.0}), at_ms(300)), 0.0);
}

TEST(HeadForecast, ASessionRendersThePredictedHeadAndSaysHowFarAhead) {
  Session session(1, "key", predicting());
  net::Welcome welcome;
  welcome.epoch = 5;
  session.begin_epoch(net::PeerId{7}, welcome, test::setup(), at_ms(0));
  std::optional<StartFrame> start;
  for (std::uint64_t i = 1; i <= 10; ++i) {
    const double ms = 50.0 * static_cast<double>(i);
    net::ViewState view = moving(i, Degrees{60.0});
    view.sampled = ClientTime{units::from_ms(ms)};
    view.predicted_display = view.sampled + units::from_ms(10.0);
    session.on_view({net::PeerId{7}, view, {5, 0, 0, 0, false}, at_ms(ms)});
    start = session.start_frame(at_ms(ms));
    ASSERT_TRUE(start);
    session.on_frame_ready(start->key, at_ms(ms + 10.0));
    session.on_view(
        {net::PeerId{7}, std::nullopt, {5, start->key.frame, 0, 0, false}, at_ms(ms + 30.0)});
  }
  EXPECT_EQ(start->horizon, units::from_ms(40.0));
  const Pose read = moving(10, Degrees{60.0}).stage_from_head;
  // 14 ms of motion are told as 50 ms here, so the head is that much slower.
  EXPECT_NEAR(Degrees{math::angle_between(start->view.stage_from_head, read)}.value(),
              60.0 * 0.04 * 14.0 / 50.0, 1e-6);
  EXPECT_EQ(start->guard_band.value(), 2.0);
}

}  // namespace
}  // namespace macula::session
