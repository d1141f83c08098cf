#include "client/pose/trace_recorder.h"

#include <gtest/gtest.h>

#include "client/pose/trace.h"

namespace macula::pose {
namespace {

using namespace std::chrono_literals;

HeadSample head_at(Nanoseconds at, double x, bool looks) {
  HeadSample head;
  head.at = ClientTime{at};
  head.stage_from_head.position.x = x;
  head.gaze.valid = looks;
  return head;
}

TEST(TraceRecorder, WhatIsRecordedPlaysAgain) {
  const std::string path = testing::TempDir() + "recorded.csv";
  auto recorder = TraceRecorder::create(path);
  ASSERT_TRUE(recorder);
  (*recorder)->add(head_at(5s, 1.0, true));
  (*recorder)->add(head_at(5s + 10us, 7.0, true));  // too soon for the file's resolution
  (*recorder)->add(head_at(5s + 20ms, 2.0, false));
  ASSERT_TRUE((*recorder)->finish());
  const auto trace = load_trace(path);
  ASSERT_TRUE(trace) << trace.error().message();
  ASSERT_EQ(trace->samples.size(), 2U);
  EXPECT_EQ(trace->samples[1].at, 20ms);
  EXPECT_EQ(trace->samples[1].stage_from_head.position.x, 2.0);
  EXPECT_TRUE(trace->samples[0].gaze);
  EXPECT_FALSE(trace->samples[1].gaze);
}

TEST(TraceRecorder, NamesAFileThatCannotBeMade) {
  const auto recorder = TraceRecorder::create("/nowhere/at/all.csv");
  ASSERT_FALSE(recorder);
  EXPECT_EQ(recorder.error().where, "/nowhere/at/all.csv");
}

TEST(TraceRecorder, SaysWhenTheDiskIsFull) {
  auto recorder = TraceRecorder::create("/dev/full");
  ASSERT_TRUE(recorder);
  (*recorder)->add(head_at(1s, 0.0, true));
  const auto finished = (*recorder)->finish();
  ASSERT_FALSE(finished);
  EXPECT_EQ(finished.error().exit_status(), 1);
}

}  // namespace
}  // namespace macula::pose
