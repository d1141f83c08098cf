#include "client/app/doctor.h"

#include <gtest/gtest.h>

namespace macula::client_app {
namespace {

using Verdict = Finding::Verdict;
using namespace std::chrono_literals;

StreamTrial healthy() {
  net::ClockEstimate clock;
  clock.min_rtt = 2ms;
  clock.bound = 1ms;
  return {3s, 120, 3'000'000, clock};
}

TEST(Doctor, FindsAHealthyStreamGoodAndTellsItsRate) {
  const auto findings = judge(healthy());
  ASSERT_EQ(findings.size(), 2U);
  EXPECT_EQ(findings[0].verdict, Verdict::Good);
  EXPECT_NE(findings[0].text.find("40 a second, 8 Mbit/s"), std::string::npos) << findings[0].text;
  EXPECT_EQ(findings[1].verdict, Verdict::Good);
}

TEST(Doctor, SaysWhatToDoAboutFewFramesAndLongRoundTrips) {
  StreamTrial trial = healthy();
  trial.frames = 6;
  trial.clock->min_rtt = 80ms;
  const auto findings = judge(trial);
  EXPECT_EQ(findings[0].verdict, Verdict::Note);
  EXPECT_NE(findings[0].text.find("--target-ms"), std::string::npos);
  EXPECT_EQ(findings[1].verdict, Verdict::Note);
  EXPECT_NE(findings[1].text.find("nearer link"), std::string::npos);
}

TEST(Doctor, FindsSilenceBad) {
  for (const Finding& finding : judge({3s, 0, 0, std::nullopt}))
    EXPECT_EQ(finding.verdict, Verdict::Bad) << finding.subject;
}

}  // namespace
}  // namespace macula::client_app
