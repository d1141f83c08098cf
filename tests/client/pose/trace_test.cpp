#include "client/pose/trace.h"

#include <gtest/gtest.h>

#include "tests/support/handed_data.h"

namespace macula::pose {
namespace {

const std::string kHeader = "t_s,px,py,pz,qx,qy,qz,qw,gx,gy,gz\n";

/// The complaint about a text that must not parse.
std::string complaint(const std::string& text) {
  const auto trace = parse_trace(text, "t.csv");
  return trace ? "parsed" : trace.error().message();
}

TEST(Trace, ReadsEveryColumn) {
  const auto trace =
      parse_trace(kHeader + "0.5,1,2,3,0,0.6,0,0.8,0,0,-1\r\n0.75,1,2,3,0,0,0,1,,,\n", "t.csv");
  ASSERT_TRUE(trace) << trace.error().message();
  ASSERT_EQ(trace->samples.size(), 2U);
  const TraceSample& first = trace->samples[0];
  EXPECT_EQ(first.at, units::from_ms(500.0));
  EXPECT_EQ(first.stage_from_head.position, DVec3(1.0, 2.0, 3.0));
  EXPECT_DOUBLE_EQ(first.stage_from_head.rotation.y, 0.6);
  EXPECT_DOUBLE_EQ(first.stage_from_head.rotation.w, 0.8);
  EXPECT_EQ(first.gaze, Vec3(0.0F, 0.0F, -1.0F));
  EXPECT_FALSE(trace->samples[1].gaze.has_value());
  EXPECT_EQ(trace->duration(), units::from_ms(250.0));
}

TEST(Trace, NamesAMissingColumn) {
  EXPECT_EQ(
      complaint("t_s,px,py,pz,qx,qy,qz,gx,gy,gz\n"),
      "t.csv:1: column 'qw' is missing (the first line must read " + kHeader.substr(0, 33) + ")");
  EXPECT_EQ(
      complaint("0.0,0,0,0,0,0,0,1,,,\n"),
      "t.csv:1: column 't_s' is missing (the first line must read " + kHeader.substr(0, 33) + ")");
  EXPECT_EQ(complaint("px,t_s,py,pz,qx,qy,qz,qw,gx,gy,gz\n"),
            "t.csv:1: the columns are not in the order expected (the first line must read " +
                kHeader.substr(0, 33) + ")");
}

TEST(Trace, NamesALineWithTooFewColumns) {
  EXPECT_EQ(complaint(kHeader + "0,0,0,0,0,0,0,1\n"),
            "t.csv:2: 8 columns instead of 11 (every line holds " + kHeader.substr(0, 33) + ")");
}

TEST(Trace, NamesWhatIsNotAFiniteNumber) {
  EXPECT_EQ(
      complaint(kHeader + "0,0,0,0,0,0,0,1,,,\n0.1,0,nan,0,0,0,0,1,,,\n"),
      "t.csv:3, column 3 (py): 'nan' is not a finite number (a decimal number such as -0.25)");
  EXPECT_EQ(
      complaint(kHeader + "0,0,1.5x,0,0,0,0,1,,,\n"),
      "t.csv:2, column 3 (py): '1.5x' is not a finite number (a decimal number such as -0.25)");
  EXPECT_EQ(complaint(kHeader + "0,,0,0,0,0,0,1,,,\n"),
            "t.csv:2, column 2 (px): '' is not a finite number (a decimal number such as -0.25)");
  EXPECT_EQ(
      complaint(kHeader + "0,0,0,0,0,0,0,1,inf,0,0\n"),
      "t.csv:2, column 9 (gx): 'inf' is not a finite number (a decimal number, or nothing: no "
      "gaze)");
  EXPECT_EQ(
      complaint(kHeader + "0,0,0,0,0,0,0,1e999,,,\n"),
      "t.csv:2, column 8 (qw): '1e999' is not a finite number (a decimal number such as -0.25)");
}

TEST(Trace, NamesTimeThatDoesNotIncrease) {
  const std::string sample = ",0,0,0,0,0,0,1,,,\n";
  EXPECT_EQ(
      complaint(kHeader + "0" + sample + "0.5" + sample + "0.5" + sample),
      "t.csv:4, column 1 (t_s): time 0.5 s does not increase (the line before has 0.5 s) (t_s "
      "rises from line to line)");
  EXPECT_EQ(complaint(kHeader + "1e12" + sample),
            "t.csv:2, column 1 (t_s): time 1e+12 s is out of range (seconds from the start of the "
            "recording)");
}

TEST(Trace, NamesAQuaternionThatIsNotUnitWithinOnePercent) {
  EXPECT_EQ(complaint(kHeader + "0,0,0,0,0,0,0,1.02,,,\n"),
            "t.csv:2, column 5 (qx): quaternion qx,qy,qz,qw has length 1.02 (length 1 within 1 %)");
  const std::string good = kHeader + "0,0,0,0,0,0,0,1.009,,,\n1,0,0,0,0,0,0,0.991,,,\n";
  const auto trace = parse_trace(good, "t.csv");
  ASSERT_TRUE(trace) << trace.error().message();
  EXPECT_DOUBLE_EQ(trace->samples[0].stage_from_head.rotation.w, 1.0);
}

TEST(Trace, NamesAGazeThatIsIncompleteOrNotUnit) {
  EXPECT_EQ(complaint(kHeader + "0,0,0,0,0,0,0,1,0,,-1\n"),
            "t.csv:2, column 9 (gx): gaze gx,gy,gz is given in part (all three numbers, or none of "
            "them)");
  EXPECT_EQ(complaint(kHeader + "0,0,0,0,0,0,0,1,0,0,0\n"),
            "t.csv:2, column 9 (gx): gaze gx,gy,gz has length 0 (length 1 within 1 %)");
}

TEST(Trace, NeedsTwoSamples) {
  EXPECT_EQ(
      complaint(kHeader + "0,0,0,0,0,0,0,1,,,\n"),
      "t.csv: a trace of 1 samples (a line " + kHeader.substr(0, 33) + " and two samples or more)");
  EXPECT_EQ(complaint(""), "t.csv: a trace of 0 samples (a line " + kHeader.substr(0, 33) +
                               " and two samples or more)");
}

TEST(Trace, NamesAFileThatIsNotThere) {
  const auto trace = load_trace("/nowhere/at/all.csv");
  ASSERT_FALSE(trace);
  EXPECT_EQ(trace.error().where, "/nowhere/at/all.csv");
  EXPECT_EQ(trace.error().exit_status(), 2);
  EXPECT_NE(trace.error().message().find("No such file"), std::string::npos);
}

// Half-way between two samples: the mean position, half of the 90 degree turn about y (the
// quaternion of 45 degrees), and the bisector of the two gazes.
TEST(Trace, InterpolatesBetweenSamples) {
  const auto trace = parse_trace(kHeader +
                                     "10,0,0,0,0,0,0,1,0,0,-1\n"
                                     "12,2,4,6,0,0.707106781,0,0.707106781,1,0,0\n",
                                 "t.csv");
  ASSERT_TRUE(trace) << trace.error().message();
  const HeadSample half = trace->at(units::from_s(1.0));
  EXPECT_EQ(half.stage_from_head.position, DVec3(1.0, 2.0, 3.0));
  EXPECT_NEAR(half.stage_from_head.rotation.y, std::sin(std::numbers::pi / 8.0), 1e-9);
  EXPECT_NEAR(half.gaze.direction.x, std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(half.gaze.direction.z, -std::sqrt(0.5), 1e-6);
  EXPECT_TRUE(half.gaze.valid);
}

TEST(Trace, HoldsItsEndsOutsideItsTime) {
  const auto trace = parse_trace(kHeader + "0,1,0,0,0,0,0,1,,,\n1,2,0,0,0,0,0,1,,,\n", "t.csv");
  ASSERT_TRUE(trace);
  EXPECT_EQ(trace->at(units::from_s(-1.0)).stage_from_head.position.x, 1.0);
  EXPECT_EQ(trace->at(units::from_s(9.0)).stage_from_head.position.x, 2.0);
}

TEST(Trace, TakesTheNearerGazeAcrossAGap) {
  const auto trace = parse_trace(kHeader + "0,0,0,0,0,0,0,1,0,0,-1\n1,0,0,0,0,0,0,1,,,\n", "t.csv");
  ASSERT_TRUE(trace);
  EXPECT_TRUE(trace->at(units::from_ms(400.0)).gaze.valid);
  EXPECT_FALSE(trace->at(units::from_ms(600.0)).gaze.valid);
}

TEST(Trace, SurvivesARoundTripThroughCsv) {
  const auto trace = parse_trace(kHeader +
                                     "0,1.25,2,3,0,0.6,0,0.8,0,0.6,-0.8\n"
                                     "0.0139,1,2,-3,0,0,0,1,,,\n",
                                 "t.csv");
  ASSERT_TRUE(trace);
  const auto again = parse_trace(to_csv(*trace), "again.csv");
  ASSERT_TRUE(again) << again.error().message();
  EXPECT_EQ(to_csv(*again), to_csv(*trace));
  EXPECT_EQ(again->samples[0].gaze, trace->samples[0].gaze);
  EXPECT_FALSE(again->samples[1].gaze.has_value());
}

TEST(Trace, ReadsEveryRecordedTrace) {
  MACULA_NEEDS_HANDED_DATA("traces");
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(test::handed_data() / "traces")) {
    if (entry.path().extension() != ".csv") continue;
    const auto trace = load_trace(entry.path().string());
    ASSERT_TRUE(trace) << trace.error().message();
    EXPECT_GT(trace->duration(), units::from_s(40.0));
    ++files;
  }
  EXPECT_EQ(files, 11);
}

}  // namespace
}  // namespace macula::pose
