#include "server/session/frame_log.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

namespace macula::session {
namespace {

using namespace std::chrono_literals;

ServerTime at(Nanoseconds since_start) {
  return ServerTime{since_start};
}

/// View at 0, render from 3 to 13, encoded at 18 ms.
FrameJob job_of(std::uint64_t frame) {
  FrameJob job;
  job.start.key = {1, 77, frame};
  job.start.view_received = at(0ms);
  job.render_begin = at(3ms);
  job.render_end = at(13ms);
  job.encode_end = at(18ms);
  job.encoded.color_bytes = 1234567;
  job.report.trace_ms = 6.5;
  return job;
}

net::FrameSent sent(std::uint64_t frame, bool lost = false) {
  return {net::PeerId{1}, 77, frame, at(20ms), at(27ms), lost};
}

class FrameLogTest : public testing::Test {
 protected:
  FrameLogTest() { log_ = std::move(*FrameLog::create(folder_)); }
  std::string text_of(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(folder_ + "/" + name).rdbuf();
    return text.str();
  }

  const test::TemporaryFolder parent_;
  const std::string folder_ = parent_.path() + "/made/here";
  std::unique_ptr<FrameLog> log_;
};

TEST_F(FrameLogTest, EachStageIsBetweenItsOwnStamps) {
  log_->add(job_of(5));
  log_->on_sent(sent(5));
  ASSERT_TRUE(log_->finish({}));
  const std::string csv = text_of("frames.csv");
  EXPECT_EQ(
      csv.rfind("epoch,frame,view_wait_ms,render_ms,encode_ms,credit_wait_ms,send_queue_ms,", 0),
      0U)
      << csv;
  EXPECT_NE(csv.find("\n77,5,3,10,5,2,7,0,6.5,"), std::string::npos) << csv;
  EXPECT_NE(csv.find(",1234567,"), std::string::npos) << "bytes are whole: " << csv;
}

TEST_F(FrameLogTest, ALostFrameIsListedButNotCountedAmongThoseThatLeft) {
  for (const std::uint64_t frame : {1, 2, 3}) log_->add(job_of(frame));
  log_->on_sent(sent(1));
  log_->on_sent(sent(2, true));
  log_->on_sent(sent(9));  // never added
  Telemetry telemetry;
  telemetry.frames_encoded = 3;
  ASSERT_TRUE(log_->finish(telemetry));
  const std::string csv = text_of("frames.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 3) << csv;
  EXPECT_NE(csv.find(",1\n"), std::string::npos) << "the lost one says so: " << csv;
  const auto json = nlohmann::json::parse(text_of("report.json"));
  EXPECT_EQ(json["frames_encoded"], 3);
  EXPECT_EQ(json["frames"]["send_queue_ms"]["p50"], 7.0);
}

TEST_F(FrameLogTest, WithoutAnyFrameTheReportSaysNothingOfTheirTimes) {
  ASSERT_TRUE(log_->finish({}));
  EXPECT_TRUE(nlohmann::json::parse(text_of("report.json"))["frames"]["render_ms"].is_null());
}

TEST(FrameLog, AFolderThatCannotBeMadeIsNamed) {
  const auto log = FrameLog::create("/proc/no/such");
  ASSERT_FALSE(log);
  EXPECT_NE(log.error().message().find("/proc/no/such"), std::string::npos);
}

}  // namespace
}  // namespace macula::session
