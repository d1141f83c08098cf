#include "client/app/run_client.h"

#include <gtest/gtest.h>
#include <filesystem>

#include "shared/foveation/eccentricity.h"
#include "tests/client/app/fake_endpoint.h"

namespace macula::client_app {
namespace {

using Manner = test::FakeEndpoint::Manner;

ClientConfig small_config() {
  ClientConfig config;
  config.display = DisplayKind::Headless;
  config.width_px = test::kFrameWidth;
  config.height_px = test::kFrameHeight;
  config.vertical_fov = Degrees{60.0};
  config.pacing = Pacing::AsFastAsPossible;
  config.frames = 40;
  config.connect_patience = units::from_ms(200.0);
  return config;
}

class RunClient : public testing::Test {
 protected:
  Result<display::ClientReport> run(const ClientConfig& config, test::FakeEndpoint& endpoint) {
    return run_client(config, endpoint, clock_, stop_);
  }

  const base::SteadyClock clock_;
  std::atomic<bool> stop_{false};
};

TEST_F(RunClient, ShowsAsManyFramesAsAskedEachANewOne) {
  test::FakeEndpoint endpoint(clock_);
  const auto report = run(small_config(), endpoint);
  ASSERT_TRUE(report) << report.error().message();
  EXPECT_EQ(report->ended, display::RunEnd::FramesShown);
  EXPECT_EQ(report->shown_frames, 40U);
  EXPECT_EQ(report->distinct_server_frames, 40U);
  EXPECT_EQ(report->frames_out_of_order, 0U);
  EXPECT_EQ(report->welcome->scene.name, "known pixels");
  EXPECT_TRUE(endpoint.said_bye());
}

TEST_F(RunClient, AccountsForTheTimeOfEveryFrameButTheLast) {
  test::FakeEndpoint endpoint(clock_);
  const auto report = run(small_config(), endpoint);
  ASSERT_TRUE(report);
  EXPECT_GE(report->accounts.size(), 39U);
  for (const auto& account : report->accounts) {
    EXPECT_LE(std::chrono::abs(account.times.total - account.times.sum()), units::from_ms(0.2));
  }
}

TEST_F(RunClient, StepsTheTraceByOneRefreshAFrameWhateverTheClockSays) {
  const std::string path = testing::TempDir() + "steps.csv";
  std::FILE* file = std::fopen(path.c_str(), "w");
  ASSERT_NE(file, nullptr);
  std::fputs("t_s,px,py,pz,qx,qy,qz,qw,gx,gy,gz\n0,0,0,0,0,0,0,1,,,\n1,10,0,0,0,0,0,1,,,\n", file);
  std::fclose(file);
  ClientConfig config = small_config();
  config.trace_file = path;
  config.refresh_hz = 20.0;
  config.frames = 0;
  test::FakeEndpoint endpoint(clock_);
  const auto report = run(config, endpoint);
  ASSERT_TRUE(report) << report.error().message();
  EXPECT_EQ(report->ended, display::RunEnd::PosesEnded);
  EXPECT_EQ(report->shown_frames, 21U);  // 0, 0.05, ..., 1 s
  std::vector<double> positions;
  for (const auto& view : endpoint.views()) {
    const double x = view.stage_from_head.position.x;
    if (positions.empty() || x != positions.back()) positions.push_back(x);
  }
  ASSERT_EQ(positions.size(), 21U);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    EXPECT_NEAR(positions[i], 0.5 * static_cast<double>(i), 1e-9);
  }
}

TEST_F(RunClient, PublishesRisingSequencesWithStampsThatFit) {
  test::FakeEndpoint endpoint(clock_);
  ASSERT_TRUE(run(small_config(), endpoint));
  const auto views = endpoint.views();
  for (std::size_t i = 0; i < views.size(); ++i) {
    EXPECT_EQ(views[i].sequence, i + 1);
    EXPECT_EQ(views[i].predicted_display - views[i].sampled, units::from_s(1.0 / 72.0));
    EXPECT_EQ(views[i].gaze_sampled, views[i].sampled);
    EXPECT_EQ(views[i].eyes.size(), 2U);
  }
}

TEST_F(RunClient, CountsTheGazeChangesOfTheDemoTrace) {
  ClientConfig config = small_config();
  config.frames = 144;  // two seconds
  test::FakeEndpoint endpoint(clock_);
  const auto report = run(config, endpoint);
  ASSERT_TRUE(report);
  EXPECT_GE(report->gaze_changes_over_10_deg, 2U);
  EXPECT_LE(report->gaze_changes_over_10_deg, 4U);
}

TEST_F(RunClient, LeavesPicturesAndAReport) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "run_client_out";
  std::filesystem::remove_all(folder);
  ClientConfig config = small_config();
  config.out_folder = folder.string();
  test::FakeEndpoint endpoint(clock_);
  const auto report = run(config, endpoint);
  ASSERT_TRUE(report) << report.error().message();
  for (const char* name : {"eye_left.png", "eye_right.png", "contact_sheet.png", "rate_map.png",
                           "report.json", "frames/000000_left.png"}) {
    EXPECT_TRUE(std::filesystem::exists(folder / name)) << name;
  }
  EXPECT_GT(report->pictures_written, 0U);
  std::filesystem::remove_all(folder);
}

TEST_F(RunClient, KeepsShowingTheLastFrameInRealTime) {
  ClientConfig config = small_config();
  config.pacing = Pacing::RealTime;
  config.refresh_hz = 200.0;
  config.frames = 30;
  test::FakeEndpoint endpoint(clock_, Manner::FallsSilentAfterFive);
  const auto report = run(config, endpoint);
  ASSERT_TRUE(report) << report.error().message();
  EXPECT_EQ(report->shown_frames, 30U);
  EXPECT_LE(report->distinct_server_frames, 5U);
  EXPECT_GT(report->ages.pose_ms.largest(), units::to_ms(units::from_ms(50.0)));
}

TEST_F(RunClient, EndsAHeadlessRunWhenTheServerStaysSilent) {
  ClientConfig config = small_config();
  config.frame_patience = units::from_ms(10.0);
  config.silence_patience = units::from_ms(60.0);
  test::FakeEndpoint endpoint(clock_, Manner::FallsSilentAfterFive);
  const auto report = run(config, endpoint);
  ASSERT_TRUE(report) << report.error().message();
  EXPECT_EQ(report->ended, display::RunEnd::ServerSilent);
}

TEST_F(RunClient, SaysWhatToDoWhenNobodyAnswers) {
  test::FakeEndpoint endpoint(clock_, Manner::NeverWelcomes);
  const auto report = run(small_config(), endpoint);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().exit_status(), 1);
  EXPECT_EQ(report.error().message(),
            "tcp://127.0.0.1:7788: no answer within 0.2 s (is macula-server running there? compare "
            "its --bind with this program's --connect, and both programs' --keys)");
}

TEST_F(RunClient, HandsOnTheServersOwnRefusal) {
  test::FakeEndpoint endpoint(clock_, Manner::Refuses);
  const auto report = run(small_config(), endpoint);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().message(), "tcp://127.0.0.1:7788: update the client to version 2");
}

TEST_F(RunClient, StopsWhenInterrupted) {
  stop_ = true;
  test::FakeEndpoint endpoint(clock_);
  ClientConfig config = small_config();
  const auto report = run(config, endpoint);
  ASSERT_FALSE(report);
  EXPECT_NE(report.error().message().find("interrupted"), std::string::npos);
}

TEST_F(RunClient, FindsAMalformedTraceBeforeAnythingElse) {
  ClientConfig config = small_config();
  config.trace_file = "/nowhere/trace.csv";
  test::FakeEndpoint endpoint(clock_, Manner::NeverWelcomes);
  const auto report = run(config, endpoint);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().exit_status(), 2);
  EXPECT_EQ(report.error().where, "/nowhere/trace.csv");
}

}  // namespace
}  // namespace macula::client_app
