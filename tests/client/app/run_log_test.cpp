#include "client/app/run_log.h"

#include <gtest/gtest.h>

namespace macula::client_app {
namespace {

Showing showing(std::uint32_t epoch, std::uint64_t number) {
  auto frame = std::make_shared<frames::DecodedFrame>();
  frame->begin.epoch = epoch;
  frame->begin.frame = number;
  frame->bytes = 1000;
  Showing made;
  made.frame = frame;
  made.warps = {{90, 10, 0}, {50, 0, 50}};
  made.shown = ClientTime{units::from_ms(40.0)};
  return made;
}

TEST(RunLog, CountsShowingsAndTheFramesBehindThem) {
  RunLog log;
  for (const std::uint64_t number : {1U, 1U, 2U, 5U, 5U}) log.note_shown(showing(3, number), {});
  const auto report = log.report();
  EXPECT_EQ(report.shown_frames, 5U);
  EXPECT_EQ(report.distinct_server_frames, 3U);
  EXPECT_EQ(report.frames_out_of_order, 0U);
  EXPECT_EQ(report.frame_bytes.count(), 3U);
  EXPECT_EQ(report.ages.pose_ms.count(), 5U);
}

TEST(RunLog, SeesAFrameThatIsShownAfterANewerOne) {
  RunLog log;
  for (const std::uint64_t number : {1U, 3U, 2U, 4U}) log.note_shown(showing(3, number), {});
  EXPECT_EQ(log.report().frames_out_of_order, 1U);
}

TEST(RunLog, TakesANewEpochAsProgress) {
  RunLog log;
  log.note_shown(showing(9, 50), {});
  log.note_shown(showing(2, 1), {});
  EXPECT_EQ(log.report().frames_out_of_order, 0U);
  EXPECT_EQ(log.report().distinct_server_frames, 2U);
}

TEST(RunLog, AveragesWhatTheWarpCouldNotCover) {
  RunLog log;
  log.note_shown(showing(1, 1), {});
  EXPECT_DOUBLE_EQ(log.report().filled_share.mean(), 0.05);
  EXPECT_DOUBLE_EQ(log.report().outside_share.largest(), 0.5);
}

}  // namespace
}  // namespace macula::client_app
