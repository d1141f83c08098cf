#include "client/app/run_client.h"

#include <filesystem>
#include <memory>
#include <utility>

#include "client/app/connect.h"
#include "client/app/display_loop.h"
#include "client/app/frame_receiver.h"
#include "client/app/screen.h"
#include "client/display/headless/rate_map.h"
#include "client/pose/trace_source.h"

namespace macula::client_app {
namespace {

/// What can fail before anyone is spoken to.
struct Prepared {
  std::unique_ptr<Screen> screen;
  std::unique_ptr<pose::PoseSource> poses;
  std::unique_ptr<display::PictureWriter> pictures;  // null: none are kept
};

Result<std::unique_ptr<pose::PoseSource>> make_poses(const ClientConfig& config, Screen& screen) {
  if (config.trace_file.empty()) return screen.viewer();
  auto trace = pose::load_trace(config.trace_file);
  if (!trace) return base::forward(trace);
  const bool repeat = config.repeat_trace == ClientConfig::Repeat::Yes;
  return std::make_unique<pose::TraceSource>(std::move(*trace),
                                             repeat ? pose::AtEnd::Loop : pose::AtEnd::Stop);
}

Result<Prepared> prepare(const ClientConfig& config) {
  Prepared prepared;
  auto screen = make_screen(config);
  if (!screen) return base::forward(screen);
  prepared.screen = std::move(*screen);
  auto poses = make_poses(config, *prepared.screen);
  if (!poses) return base::forward(poses);
  prepared.poses = std::move(*poses);
  if (config.out_folder.empty()) return prepared;
  display::PictureOptions options;
  options.folder = config.out_folder;
  options.every = config.picture_every;
  auto pictures = display::PictureWriter::create(options);
  if (!pictures) return base::forward(pictures);
  prepared.pictures = std::move(*pictures);
  return prepared;
}

display::EyePictures rate_maps(const frames::FramePtr& frame, const foveation::Display& display) {
  display::EyePictures maps;
  if (!frame) return maps;
  for (const net::FrameView& view : frame->begin.views) {
    maps.push_back(display::draw_rate_map(view.grid, display, view.gaze));
  }
  return maps;
}

/// Last pictures, the map and report.json.
Result<void> write_results(const ClientConfig& config, const DisplayLoop& loop,
                           display::PictureWriter& pictures, display::ClientReport& report) {
  const bool shown = loop.last_frame() != nullptr;
  const auto done = pictures.finish(shown ? loop.pictures() : display::EyePictures{},
                                    rate_maps(loop.last_frame(), eye_display(config)));
  report.pictures_written = pictures.written();
  report.pictures_skipped = pictures.skipped();
  const auto path = std::filesystem::path(config.out_folder) / "report.json";
  const auto written = display::write_report(path.string(), report);
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
                            prepared.pictures.get(), stop});
  const display::RunEnd ended = loop.run();
  endpoint.send(net::Bye{name(ended), 0});

  display::ClientReport report = log.report();
  report.ended = ended;
  report.duration_s = units::to_s(clock.now() - begin);
  report.refreshes_missed = loop.missed_refreshes();
  report.frames_undecodable = receiver.undecodable();
  report.clock = endpoint.clock();
  report.network = endpoint.counters();
  report.welcome = std::move(*welcome);
  report.config = describe(config);
  if (prepared.pictures) {
    const auto written = write_results(config, loop, *prepared.pictures, report);
    if (!written) return base::forward(written);
  }
  return report;
}

}  // namespace

Result<display::ClientReport> run_client(const ClientConfig& config, net::ClientEndpoint& endpoint,
                                         const base::Clock& clock, const std::atomic<bool>& stop) {
  auto prepared = prepare(config);
  if (!prepared) return base::forward(prepared);
  return run_prepared(config, *prepared, endpoint, clock, stop);
}

Result<display::ClientReport> run_client(const ClientConfig& config, const base::Clock& clock,
                                         const std::atomic<bool>& stop) {
  auto prepared = prepare(config);
  if (!prepared) return base::forward(prepared);
  net::ClientEndpointOptions options;
  options.connect = config.connect;
  options.key_folder = config.key_folder;
  options.hello = make_hello(config);
  auto endpoint = net::ClientEndpoint::create(options, clock);
  if (!endpoint) return base::forward(endpoint);
  return run_prepared(config, *prepared, **endpoint, clock, stop);
}

}  // namespace macula::client_app
