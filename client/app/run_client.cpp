#include "client/app/run_client.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "client/app/connect.h"
#include "client/app/display_loop.h"
#include "client/app/frame_receiver.h"
#include "client/app/screen.h"
#include "client/display/headless/rate_map.h"
#include "client/pose/gaze_source.h"
#include "client/pose/trace_source.h"
#include "client/pose/udp_gaze.h"

namespace macula::client_app {
namespace {

/// What can fail before anyone is spoken to.
struct Prepared {
  std::unique_ptr<Screen> screen;
  std::unique_ptr<pose::PoseSource> poses;
  std::unique_ptr<pose::TraceRecorder> recorder;     // null: nothing is recorded
  std::unique_ptr<display::PictureWriter> pictures;  // null: none are kept
};

Result<std::unique_ptr<pose::PoseSource>> make_head(const ClientConfig& config, Screen& screen) {
  if (config.trace_file.empty()) return screen.viewer();
  auto trace = pose::load_trace(config.trace_file);
  if (!trace) return base::forward(trace);
  const bool repeat = config.repeat_trace == ClientConfig::Repeat::Yes;
  return std::make_unique<pose::TraceSource>(std::move(*trace),
                                             repeat ? pose::AtEnd::Loop : pose::AtEnd::Stop);
}

/// Null: it comes with the head.
Result<std::unique_ptr<pose::GazeSource>> make_gaze(const ClientConfig& config, Screen& screen,
                                                    const base::Clock& clock) {
  using GazeFrom = ClientConfig::GazeFrom;
  std::unique_ptr<pose::GazeSource> gaze;
  switch (config.gaze) {
    case GazeFrom::Head:
      break;
    case GazeFrom::Mouse:
      gaze = std::make_unique<pose::GazeOfHead>(screen.viewer());
      break;
    case GazeFrom::Target:
      gaze = std::make_unique<pose::TargetGaze>();
      break;
    case GazeFrom::Udp: {
      auto udp =
          pose::UdpGaze::create(config.gaze_address, screen.rig().eyes.front().display.fov, clock);
      if (!udp) return base::forward(udp);
      gaze = std::move(*udp);
    }
  }
  return gaze;
}

Result<std::unique_ptr<pose::PoseSource>> make_poses(const ClientConfig& config, Screen& screen,
                                                     const base::Clock& clock) {
  auto head = make_head(config, screen);
  if (!head) return head;
  auto gaze = make_gaze(config, screen, clock);
  if (!gaze) return base::forward(gaze);
  if (!*gaze) return head;
  return std::make_unique<pose::HeadWithGaze>(std::move(*head), std::move(*gaze));
}

Result<Prepared> prepare(const ClientConfig& config, const base::Clock& clock) {
  Prepared prepared;
  auto screen = make_screen(config, clock);
  if (!screen) return base::forward(screen);
  prepared.screen = std::move(*screen);
  auto poses = make_poses(config, *prepared.screen, clock);
  if (!poses) return base::forward(poses);
  prepared.poses = std::move(*poses);
  if (!config.record_file.empty()) {
    auto recorder = pose::TraceRecorder::create(config.record_file);
    if (!recorder) return base::forward(recorder);
    prepared.recorder = std::move(*recorder);
  }
  if (config.out_folder.empty()) return prepared;
  display::PictureOptions options;
  options.folder = config.out_folder;
  options.every = config.picture_every;
  auto pictures = display::PictureWriter::create(options);
  if (!pictures) return base::forward(pictures);
  prepared.pictures = std::move(*pictures);
  return prepared;
}

display::EyePictures rate_maps(const frames::FramePtr& frame, const EyeRig& rig) {
  display::EyePictures maps;
  if (!frame) return maps;
  const auto& views = frame->begin.views;
  for (std::size_t eye = 0; eye < std::min(views.size(), rig.eyes.size()); ++eye)
    maps.push_back(display::draw_rate_map(views[eye].grid, rig.eyes[eye].display, views[eye].gaze));
  return maps;
}

/// Last pictures, the map and report.json.
Result<void> write_results(const ClientConfig& config, const DisplayLoop& loop, const EyeRig& rig,
                           display::PictureWriter& pictures, display::ClientReport& report) {
  const bool shown = loop.last_frame() != nullptr;
  const auto done = pictures.finish(shown ? loop.pictures() : display::EyePictures{},
                                    rate_maps(loop.last_frame(), rig));
  report.pictures_written = pictures.written();
  report.pictures_skipped = pictures.skipped();
  const auto written = display::write_reports(config.out_folder, report);
  return done ? written : done;
}

Result<display::ClientReport> run_prepared(const ClientConfig& config, Prepared& prepared,
                                           net::ClientEndpoint& endpoint, const base::Clock& clock,
                                           const std::atomic<bool>& stop) {
  auto welcome = wait_for_welcome(endpoint, clock, config.connect, config.connect_patience, stop);
  if (!welcome) return base::forward(welcome);

  RunLog log;
  frames::FrameStore store;
  FrameReceiver receiver(endpoint, clock, store, log.book(), {config.delays.decode});
  const Nanoseconds begin = clock.now();
  DisplayLoop loop(config, {endpoint, clock, *prepared.poses, store, log, *prepared.screen,
                            prepared.pictures.get(), prepared.recorder.get(), stop});
  const display::RunEnd ended = loop.run();
  endpoint.send(net::Bye{name(ended), 0});

  display::ClientReport report = log.report();
  report.ended = ended;
  report.duration_s = units::to_s(clock.now() - begin);
  report.refreshes_missed = prepared.screen->missed_refreshes();
  report.frames_undecodable = receiver.undecodable();
  report.clock = endpoint.clock();
  report.network = endpoint.counters();
  report.welcome = std::move(*welcome);
  report.config = describe(config);
  if (prepared.recorder) {
    if (const auto written = prepared.recorder->finish(); !written) return base::forward(written);
  }
  if (prepared.pictures) {
    const auto written =
        write_results(config, loop, prepared.screen->rig(), *prepared.pictures, report);
    if (!written) return base::forward(written);
  }
  return report;
}

}  // namespace

Result<display::ClientReport> run_client(const ClientConfig& config, net::ClientEndpoint& endpoint,
                                         const base::Clock& clock, const std::atomic<bool>& stop) {
  auto prepared = prepare(config, clock);
  if (!prepared) return base::forward(prepared);
  return run_prepared(config, *prepared, endpoint, clock, stop);
}

Result<display::ClientReport> run_client(const ClientConfig& config, const base::Clock& clock,
                                         const std::atomic<bool>& stop) {
  auto prepared = prepare(config, clock);
  if (!prepared) return base::forward(prepared);
  net::ClientEndpointOptions options;
  options.connect = config.connect;
  options.key_folder = config.key_folder;
  options.hello = make_hello(config, prepared->screen->rig(), prepared->screen->refresh_hz());
  auto endpoint = net::ClientEndpoint::create(options, clock);
  if (!endpoint) return base::forward(endpoint);
  return run_prepared(config, *prepared, **endpoint, clock, stop);
}

}  // namespace macula::client_app
