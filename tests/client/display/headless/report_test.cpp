#include "client/display/headless/report.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace macula::display {
namespace {

frames::StageTimes times(double render_ms, double unattributed_ms) {
  frames::StageTimes t;
  t.stages.fill(units::from_ms(1.0));
  t.stages[static_cast<std::size_t>(frames::Stage::Render)] = units::from_ms(render_ms);
  t.unattributed = units::from_ms(unattributed_ms);
  t.total = t.sum() + t.unattributed;
  return t;
}

ClientReport some_report() {
  ClientReport report;
  report.ended = RunEnd::PosesEnded;
  report.shown_frames = 120;
  report.distinct_server_frames = 20;
  report.gaze_changes_over_10_deg = 3;
  for (int i = 1; i <= 101; ++i) report.ages.pose_ms.add(i);
  report.accounts = {{{1, 1}, times(10.0, 0.0)}, {{1, 2}, times(20.0, 0.125)}};
  report.accounts_incomplete = 18;
  report.clock = net::ClockEstimate{Nanoseconds{5}, units::from_ms(0.25), units::from_ms(0.5)};
  report.network.views_sent = 500;
  report.welcome = net::Welcome{};
  report.welcome->scene.name = "cornell";
  report.config = {{"connect", "tcp://127.0.0.1:7788"}};
  return report;
}

TEST(ClientReport, TellsWhatARunMeasured) {
  const auto json = nlohmann::json::parse(to_json(some_report()));
  EXPECT_EQ(json["ended"], "poses ended");
  EXPECT_EQ(json["shown_frames"], 120);
  EXPECT_EQ(json["distinct_server_frames"], 20);
  EXPECT_EQ(json["frames_out_of_order"], 0);
  EXPECT_EQ(json["gaze_changes_over_10_deg"], 3);
  EXPECT_EQ(json["pose_age_ms"]["p50"], 51.0);
  EXPECT_EQ(json["pose_age_ms"]["p95"], 96.0);
  EXPECT_EQ(json["stages_ms"]["render"]["p50"], 15.0);
  EXPECT_EQ(json["stages_ms"]["total"]["max"], 28.125);
  EXPECT_EQ(json["stage_accounting"]["frames_accounted"], 2);
  EXPECT_EQ(json["stage_accounting"]["frames_incomplete"], 18);
  EXPECT_EQ(json["stage_accounting"]["unattributed_max_ms"], 0.125);
  EXPECT_EQ(json["stage_accounting"]["sum_minus_total_max_ms"], 0.125);
  EXPECT_EQ(json["clock"]["bound_ms"], 0.25);
  EXPECT_EQ(json["network"]["views_sent"], 500);
  EXPECT_EQ(json["server"]["scene"], "cornell");
  EXPECT_EQ(json["config"]["connect"], "tcp://127.0.0.1:7788");
}

TEST(ClientReport, HasARowForEveryStage) {
  const auto json = nlohmann::json::parse(to_json(some_report()));
  for (const char* stage : {"uplink", "view_wait", "render", "encode", "send_queue", "downlink",
                            "decode", "reproject", "present_wait", "total"}) {
    EXPECT_TRUE(json["stages_ms"][stage].contains("p95")) << stage;
  }
}

TEST(ClientReport, IsWholeWithoutASingleFrame) {
  const auto json = nlohmann::json::parse(to_json(ClientReport{}));
  EXPECT_EQ(json["shown_frames"], 0);
  EXPECT_EQ(json["pose_age_ms"]["p95"], 0.0);
  EXPECT_TRUE(json["clock"].is_null());
}

TEST(ClientReport, KeepsTextOfThePeerThatIsNotUtf8) {
  ClientReport report = some_report();
  report.welcome->scene.name = "caf\xe9";
  EXPECT_FALSE(nlohmann::json::parse(to_json(report)).is_discarded());
}

TEST(ClientReport, NamesAFileItCannotWrite) {
  const auto written = write_reports("/nowhere/at/all", ClientReport{});
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().where, "/nowhere/at/all/report.json");
}

TEST(ClientReport, HasALineForEveryFrameWhoseTimeIsAccountedFor) {
  EXPECT_EQ(frames_csv(some_report()),
            "epoch,frame,uplink_ms,view_wait_ms,render_ms,encode_ms,send_queue_ms,downlink_ms,"
            "decode_ms,reproject_ms,present_wait_ms,unattributed_ms,total_ms\n"
            "1,1,1,1,10,1,1,1,1,1,1,0,18\n"
            "1,2,1,1,20,1,1,1,1,1,1,0.125,28.125\n");
}

}  // namespace
}  // namespace macula::display
