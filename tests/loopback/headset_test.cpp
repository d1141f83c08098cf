// The whole way to a headset: a real server, real sockets, the real client, and a runtime whose
// head, eyes and gaze are written down beforehand.
#include <algorithm>
#include <cmath>
#include <mutex>

#include "client/app/run_client.h"
#include "tests/loopback/server_fixture.h"
#include "tests/support/null_runtime/null_headset.h"

namespace macula::loopback {
namespace {

/// Remembers what passes.
class ListeningEndpoint final : public net::ClientEndpoint {
 public:
  explicit ListeningEndpoint(std::unique_ptr<net::ClientEndpoint> endpoint)
      : endpoint_(std::move(endpoint)) {}

  void publish(net::ViewState view) override {
    views.push_back(view);
    endpoint_->publish(std::move(view));
  }
  void send(net::Message message) override { endpoint_->send(std::move(message)); }
  std::optional<net::ReceivedFrame> wait_frame(Nanoseconds timeout) override {
    auto frame = endpoint_->wait_frame(timeout);
    if (frame) begins.push_back(frame->begin);
    return frame;
  }
  void request_key() override { endpoint_->request_key(); }
  std::optional<net::ClientEvent> take_event() override { return endpoint_->take_event(); }
  std::optional<net::ClockEstimate> clock() const override { return endpoint_->clock(); }
  net::ClientCounters counters() const override { return endpoint_->counters(); }

  // Read after the run: one thread writes each.
  std::vector<net::ViewState> views;
  std::vector<net::FrameBegin> begins;

 private:
  std::unique_ptr<net::ClientEndpoint> endpoint_;
};

class HeadsetStream : public test::NullHeadsetTest {
 protected:
  display::ClientReport run(std::uint64_t frames) {
    LoopbackServer server(keys_.path());
    client_app::ClientConfig config;
    config.display = client_app::DisplayKind::OpenXr;
    config.width_px = config.height_px = 0;
    config.connect = server->endpoint();
    config.connect_patience = 60s;
    config.frames = frames;
    config.out_folder = keys_.path() + "/out";
    net::ClientEndpointOptions options;
    options.connect = server->endpoint();
    options.key_folder = keys_.path();
    options.server_key_z85 = server->public_key_z85();
    options.hello = make_hello(config, scripted_rig(), runtime_.script.refresh_hz);
    listening_ = std::make_unique<ListeningEndpoint>(
        std::move(*net::ClientEndpoint::create(options, clock_)));
    const std::atomic<bool> stop{false};
    auto report = run_client(config, *listening_, clock_, stop);
    if (report) return std::move(*report);
    ADD_FAILURE() << report.error().message();
    return {};
  }

  client_app::EyeRig scripted_rig() const {
    client_app::EyeRig rig;
    for (const test::NullFov& fov : runtime_.script.fov) {
      rig.eyes.push_back(
          {Pose{},
           {{Radians{fov.left}, Radians{fov.right}, Radians{fov.up}, Radians{fov.down}},
            runtime_.script.width_px,
            runtime_.script.height_px}});
    }
    return rig;
  }

  TemporaryFolder keys_;
  const base::SteadyClock clock_;
  std::unique_ptr<ListeningEndpoint> listening_;
};

double degrees_between(const Vec3& a, const Vec3& b) {
  const double cosine = glm::dot(glm::normalize(DVec3(a)), glm::normalize(DVec3(b)));
  return Degrees(Radians(std::acos(std::clamp(cosine, -1.0, 1.0)))).value();
}

/// Turned by an angle about the vertical axis.
test::NullPose turned_left(double radians, float px = 0.0F, float py = 0.0F, float pz = 0.0F) {
  return {px,
          py,
          pz,
          0.0F,
          static_cast<float>(std::sin(0.5 * radians)),
          0.0F,
          static_cast<float>(std::cos(0.5 * radians))};
}

TEST_F(HeadsetStream, ShowsTheServersPicturesFromWhereTheHeadsetsEyesAre) {
  runtime_.script.capture_every = 1;
  runtime_.script.fov = {test::NullFov{-0.9F, 0.7F, 0.8F, -0.8F},
                         test::NullFov{-0.7F, 0.9F, 0.8F, -0.8F}};
  runtime_.script.heads = {{0, turned_left(0.0, 0.0F, 1.6F, 0.0F)},
                           {20, turned_left(0.3, 0.2F, 1.5F, 0.0F)}};
  const auto report = run(60);
  EXPECT_EQ(report.ended, display::RunEnd::FramesShown);
  EXPECT_EQ(report.shown_frames, 60U);
  std::size_t shown = 0;
  for (const test::NullFrame& frame : runtime_.frames) {
    if (!frame.has_layer) continue;
    ++shown;
    const bool turned = frame.index >= 20;
    EXPECT_FLOAT_EQ(frame.stage_from_eye[0].qy, turned ? std::sin(0.15F) : 0.0F) << frame.index;
    EXPECT_FLOAT_EQ(frame.fov[0].left, -0.9F);
    EXPECT_FLOAT_EQ(frame.fov[1].right, 0.9F);
    EXPECT_TRUE(frame.has_depth);
  }
  EXPECT_EQ(shown, 60U);
  // Something other than one colour is to be seen, and each eye sees its own.
  const test::NullFrame& last = runtime_.frames.back();
  const auto [darkest, lightest] = std::minmax_element(last.rgba[0].begin(), last.rgba[0].end());
  EXPECT_GT(*lightest - *darkest, 100);
  EXPECT_NE(last.rgba[0], last.rgba[1]);
  for (const net::FrameBegin& begin : listening_->begins) {
    EXPECT_FLOAT_EQ(static_cast<float>(begin.views[0].display_fov.left.value()), -0.9F);
    EXPECT_FLOAT_EQ(static_cast<float>(begin.views[1].display_fov.right.value()), 0.9F);
  }
}

TEST_F(HeadsetStream, TheFoveaFollowsTheGazeWithTheFrameOfTheSampleThatSaysSo) {
  constexpr double kTurn = 0.35;
  runtime_.script.gazes = {{0, true, {}}, {90, true, turned_left(kTurn)}};
  run(120);
  const Vec3 after{-std::sin(static_cast<float>(kTurn)), 0.0F,
                   -std::cos(static_cast<float>(kTurn))};
  const auto looks_left = [&](const Gaze& gaze) {
    return degrees_between(gaze.direction, after) < 3.0;  // the eyes converge at 1 m
  };
  const auto first =
      std::find_if(listening_->views.begin(), listening_->views.end(),
                   [&](const net::ViewState& view) { return looks_left(view.eyes[0].gaze); });
  ASSERT_NE(first, listening_->views.begin());
  ASSERT_NE(first, listening_->views.end());
  std::size_t before = 0, later = 0;
  for (const net::FrameBegin& begin : listening_->begins) {
    const bool sampled_later = begin.view_sequence >= first->sequence;
    (sampled_later ? later : before) += 1;
    EXPECT_EQ(looks_left(begin.views[0].gaze), sampled_later) << begin.view_sequence;
    // The grid's finest column is where the eye looks.
    const PixelGrid& grid = begin.views[0].grid;
    const float looked_at = begin.views[0].gaze.direction.x / -begin.views[0].gaze.direction.z;
    const auto column = grid.locate({looked_at, 0.0F});
    ASSERT_TRUE(column);
    const int x = static_cast<int>(column->x);
    for (int other = 0; other < grid.width(); ++other)
      EXPECT_LE(grid.footprint(x, 0).x, 1.001F * grid.footprint(other, 0).x);
  }
  EXPECT_GT(before, 0U);
  EXPECT_GT(later, 0U);
}

TEST_F(HeadsetStream, EndsWithAReportWhenTheRuntimeDies) {
  runtime_.script.lose_at_frame = 30;
  const auto report = run(0);
  EXPECT_EQ(report.ended, display::RunEnd::HeadsetLost);
  EXPECT_TRUE(std::filesystem::exists(keys_.path() + "/out/report.json"));
}

TEST_F(HeadsetStream, EndsWhenThePersonLeavesTheSession) {
  runtime_.script.stop_at_frame = 30;
  EXPECT_EQ(run(0).ended, display::RunEnd::HeadsetClosed);
}

}  // namespace
}  // namespace macula::loopback
