#include "client/pose/demo_trace.h"

#include <gtest/gtest.h>
#include <fstream>
#include <sstream>

#include "client/pose/saccades.h"
#include "client/pose/trace_source.h"
#include "shared/foveation/eccentricity.h"

namespace macula::pose {
namespace {

DVec3 stage_gaze(const TraceSample& sample) {
  return sample.stage_from_head.transform_direction(DVec3(*sample.gaze));
}

/// Turn of the gaze in the stage between two neighbouring samples.
Degrees gaze_turn(const Trace& trace, std::size_t i) {
  return foveation::eccentricity(stage_gaze(trace.samples[i - 1]), stage_gaze(trace.samples[i]));
}

TEST(DemoTrace, LastsTwentySecondsAndIsTheSameEveryTime) {
  const Trace trace = make_demo_trace();
  EXPECT_NEAR(units::to_s(trace.duration()), 20.0, 1.0 / 72.0);
  EXPECT_EQ(to_csv(trace), to_csv(make_demo_trace()));
  EXPECT_NE(to_csv(trace), to_csv(make_demo_trace({.seed = 2})));
}

TEST(DemoTrace, TurnsTheHeadNoFasterThanSixtyDegreesASecond) {
  const Trace trace = make_demo_trace();
  double fastest = 0.0;
  for (std::size_t i = 1; i < trace.samples.size(); ++i) {
    const auto &a = trace.samples[i - 1], &b = trace.samples[i];
    const Degrees turn = math::angle_between(a.stage_from_head, b.stage_from_head);
    fastest = std::max(fastest, turn.value() / units::to_s(b.at - a.at));
  }
  EXPECT_LE(fastest, 60.0);
  EXPECT_GE(fastest, 20.0);
}

// A saccade is a run of samples between which the stage gaze moves; at rest it does not move at
// all.
TEST(DemoTrace, MovesTheEyesTenDegreesOrMoreEveryHalfToOneSecond) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const Trace trace = make_demo_trace({.seed = seed});
    std::vector<std::size_t> starts;
    double run_deg = 0.0;
    for (std::size_t i = 1; i < trace.samples.size(); ++i) {
      const bool moving = gaze_turn(trace, i) > Degrees{0.01};
      if (moving && run_deg == 0.0) starts.push_back(i);
      if (!moving && run_deg > 0.0) {
        EXPECT_GE(run_deg, 10.0) << "saccade before sample " << i;
      }
      run_deg = moving ? run_deg + gaze_turn(trace, i).value() : 0.0;
    }
    ASSERT_GE(starts.size(), 19U);
    for (std::size_t i = 1; i < starts.size(); ++i) {
      const double apart_s =
          units::to_s(trace.samples[starts[i]].at - trace.samples[starts[i - 1]].at);
      EXPECT_GE(apart_s, 0.5 - 1.0 / 72.0);
      EXPECT_LE(apart_s, 1.0 + 1.0 / 72.0);
    }
  }
}

TEST(DemoTrace, KeepsTheEyesWithinTheirReach) {
  for (const TraceSample& sample : make_demo_trace().samples) {
    ASSERT_TRUE(sample.gaze.has_value());
    EXPECT_LT(Degrees{foveation::eccentricity(Vec3(0.0F, 0.0F, -1.0F), *sample.gaze)}.value(),
              30.0);
  }
}

TEST(DemoTrace, HasMoreThanTwoGazeChangesASaccadeCounterSees) {
  SaccadeCounter counter;
  TraceSource source(make_demo_trace());
  for (int i = 0; i < 120; ++i) {
    counter.add(*source.sample(ClientTime{units::from_s(i / 72.0)}));
  }
  EXPECT_GE(counter.count(), 2U);
}

TEST(DemoTrace, IsTheTraceThatShips) {
  std::ifstream file(std::string(MACULA_SOURCE_DIR) + "/deploy/traces/look_around.csv");
  std::ostringstream text;
  text << file.rdbuf();
  EXPECT_LT(text.str().size(), 200'000U);
  EXPECT_EQ(text.str(), to_csv(make_demo_trace()));
}

}  // namespace
}  // namespace macula::pose
