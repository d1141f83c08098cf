#include "tests/bench/streaming.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <random>

#include "client/app/eye_rig.h"
#include "client/pose/demo_trace.h"
#include "client/reprojection/warp.h"
#include "server/kernels/registry.h"
#include "server/scene/load.h"
#include "server/scene/plan.h"
#include "server/session/server.h"
#include "shared/base/text.h"
#include "shared/codec/color.h"
#include "shared/foveation/eccentricity.h"
#include "shared/metrics/error.h"
#include "shared/metrics/foveated.h"
#include "shared/net/keys.h"
#include "tests/bench/canned_kernel.h"
#include "tests/bench/progress.h"
#include "tests/bench/report.h"
#include "tests/bench/streaming_link.h"
#include "tests/bench/streaming_viewer.h"
#include "tests/support/temporary_folder.h"

namespace macula::bench {
namespace {

using base::forward;

foveation::Display display_of(const StreamingOptions& options) {
  const double aspect = static_cast<double>(options.width_px) / options.height_px;
  return {math::symmetric_fov(Degrees{options.vertical_fov_deg}, aspect), options.width_px,
          options.height_px};
}

/// What is streamed: a kernel, the scene it needs, and the pattern where it is one.
struct Source {
  std::shared_ptr<const CannedPattern> pattern;
  std::shared_ptr<kernels::SceneTimeline> scene;
  std::shared_ptr<const kernels::Kernel> kernel;
  std::string kernel_name;
  Pose scene_from_stage;
  image::Tone tone;
};

Result<Source> make_source(const StreamingOptions& options) {
  const bool is_canned = options.source == "pattern";
  auto scene = scene::load_scene(is_canned ? "cornell" : options.source);
  if (!scene) return forward(scene);
  Source source;
  auto timeline = kernels::SceneTimeline::create(*scene);
  if (!timeline) return forward(timeline);
  source.scene = std::move(*timeline);
  if (is_canned) {
    source.pattern = std::make_shared<CannedPattern>(options.noise_levels);
    source.kernel = std::make_shared<CannedKernel>(source.pattern);
    source.kernel_name = "pattern";
    return source;
  }
  std::vector<std::string_view> registered;
  for (const auto& entry : kernels::kernel_table()) registered.push_back(entry.name);
  const auto choice =
      scene::choose_kernel(scene::facts_of(**scene), scene::IndirectLight::NotWanted, registered);
  auto kernel = kernels::make_kernel(choice.kernel, {});
  if (!kernel) return forward(kernel);
  source.kernel = std::move(*kernel);
  source.kernel_name = choice.kernel;
  source.scene_from_stage = (*scene)->settings.scene_from_stage;
  source.tone = (*scene)->settings.tone;
  return source;
}

/// The JPEG quality whose stereo frame, depth included, comes nearest to the bytes asked for.
Result<int> quality_for(const StreamingOptions& options, const Source& source,
                        const PixelGrid& grid) {
  image::Plane<Rgb> radiance;
  image::Plane<float> depth_m;
  image::Plane<Rgb8> shown;
  source.pattern->fill({}, grid, 1, radiance, depth_m);
  image::encode(source.tone, radiance, shown);
  const auto depth = codec::encode_depth(depth_m);
  if (!depth) return forward(depth);
  int best = options.quality;
  double least_off = INFINITY;
  for (int quality = 5; quality <= 98; ++quality) {
    codec::ColorOptions color;
    color.jpeg_quality = quality;
    const auto bytes = codec::encode_color(shown, shown.rect(), color);
    if (!bytes) return forward(bytes);
    const double off = std::abs(2.0 * static_cast<double>(bytes->size() + depth->bytes.size()) -
                                1e3 * options.frame_kb);
    if (off < least_off) {
      least_off = off;
      best = quality;
    }
  }
  return best;
}

Result<session::ServerConfig> server_config(const StreamingOptions& options, const Source& source) {
  session::ServerConfig config;
  config.offer.kernel = source.kernel_name;
  config.offer.default_codec = options.codec;
  config.views.scene_from_stage = source.scene_from_stage;
  config.views.tone = source.tone;
  config.jpeg_quality = options.quality;
  if (options.grid == "uniform") {
    config.views.rate_model = *foveation::find_rate_model("uniform");
    config.views.guard_band = Degrees{0.0};
  }
  if (options.effort == "superfast") config.h264.effort = codec::H264Options::Effort::Superfast;
  if (options.age_ms > 0.0) config.age_goal = units::from_ms(options.age_ms);
  if (options.frame_kb > 0 && source.pattern) {
    const foveation::Display display = display_of(options);
    foveation::FovealGridOptions grid;
    grid.guard_band = config.views.guard_band;
    auto quality = quality_for(
        options, source, foveation::make_foveal_grid(display, {}, config.views.rate_model, grid));
    if (!quality) return forward(quality);
    config.jpeg_quality = *quality;
  }
  return config;
}

Result<std::unique_ptr<session::Server>> start_server(const session::ServerConfig& config,
                                                      const Source& source, const std::string& keys,
                                                      const base::Clock& clock) {
  net::ServerEndpointOptions wire;
  wire.bind = "tcp://127.0.0.1:0";
  wire.key_folder = keys;
  auto endpoint = net::ServerEndpoint::create(wire, clock);
  if (!endpoint) return forward(endpoint);
  session::ServerParts parts;
  parts.endpoint = std::move(*endpoint);
  parts.scene = source.scene;
  parts.kernel = source.kernel;
  parts.scheduler = std::make_shared<scheduling::TileScheduler>(0);
  parts.clock = &clock;
  parts.random = [random = std::make_shared<std::mt19937_64>(7)] { return (*random)(); };
  auto server = session::Server::create(config, std::move(parts));
  if (!server) return forward(server);
  (*server)->start();
  return server;
}

/// Turns the proxy's knobs at their share of the run.
class LinkScript {
 public:
  LinkScript(const StreamingLink& link, support::ChaosProxy* proxy, const base::Clock& clock)
      : link_(link), proxy_(proxy), clock_(clock) {
    if (proxy_ == nullptr) return;
    for (const auto direction : {support::Direction::ToServer, support::Direction::ToClient}) {
      proxy_->shape(direction, link.shape);
    }
    if (link.down) proxy_->follow(support::Direction::ToClient, *link.down);
    if (link.up) proxy_->follow(support::Direction::ToServer, *link.up);
  }
  void at(double share) {
    if (proxy_ == nullptr) return;
    if (link_.outage.count() > 0) play_outage(share);
    if (link_.slow_bytes_per_s > 0.0) play_slow(share);
  }
  std::optional<ClientTime> trouble_began() const { return began_; }
  std::optional<ClientTime> trouble_ended() const { return ended_; }

 private:
  ClientTime now() const { return ClientTime{clock_.now()}; }
  void play_outage(double share) {
    if (!began_ && share >= link_.outage_from) {
      began_ = now();
      proxy_->stall(support::Direction::ToClient);
      proxy_->stall(support::Direction::ToServer);
    }
    if (began_ && !ended_ && now() - *began_ >= link_.outage) {
      ended_ = now();
      proxy_->resume(support::Direction::ToClient);
      proxy_->resume(support::Direction::ToServer);
    }
  }
  void play_slow(double share) {
    if (!began_ && share >= link_.slow_from) {
      began_ = now();
      support::LinkShape slow = link_.shape;
      slow.bytes_per_s = link_.slow_bytes_per_s;
      slow.buffer_bytes = 32768;
      proxy_->shape(support::Direction::ToClient, slow);
    }
    if (began_ && !ended_ && share >= link_.slow_until) {
      ended_ = now();
      proxy_->shape(support::Direction::ToClient, link_.shape);
    }
  }

  const StreamingLink& link_;
  support::ChaosProxy* proxy_;
  const base::Clock& clock_;
  std::optional<ClientTime> began_, ended_;
};

struct Judged {
  double f10_db = NAN, out10_db = NAN, gp_db = NAN;
};

/// The source of a frame, on any grid.
image::Plane<Rgb8> source_picture(const Source& source, const net::FrameBegin& begin,
                                  const PixelGrid& grid) {
  image::Plane<Rgb> radiance;
  image::Plane<float> depth_m;
  image::Plane<Rgb8> shown;
  source.pattern->fill(begin.views[0].stage_from_view, grid, begin.frame, radiance, depth_m);
  image::encode(begin.views[0].tone, radiance, shown);
  return shown;
}

/// Mean squared error of cells nearer to the gaze than 10 degrees, and of the others.
void add_cell_errors(const frames::DecodedFrame& frame, const image::Plane<Rgb8>& truth,
                     std::array<double, 2>& squares, std::array<double, 2>& counts) {
  const net::FrameView& view = frame.begin.views[0];
  const image::Plane<Rgb8>& color = frame.eyes[0].color;
  for (int y = 0; y < color.height(); ++y) {
    for (int x = 0; x < color.width(); ++x) {
      const Degrees e = foveation::eccentricity(view.gaze.direction, view.grid.ray(x, y));
      const std::size_t outside = e.value() <= 10.0 ? 0 : 1;
      const Rgb8 a = color(x, y), b = truth(x, y);
      squares[outside] += std::pow(a.r - b.r, 2) + std::pow(a.g - b.g, 2) + std::pow(a.b - b.b, 2);
      counts[outside] += 3.0;
    }
  }
}

double gp_psnr_of(const frames::DecodedFrame& frame, const Source& source,
                  const foveation::Display& display) {
  const net::FrameView& view = frame.begin.views[0];
  image::Plane<Rgb8> shown(display.width_px, display.height_px);
  reprojection::Warper().warp(
      {view.stage_from_view, view.grid, frame.eyes[0].color, frame.eyes[0].inverse_depth_per_m},
      view.stage_from_view, display, {}, shown);
  const auto truth = source_picture(source, frame.begin, foveation::make_uniform_grid(display));
  const DVec2 pixel = display.pixel_tangent(), low = display.fov.tangent_min();
  metrics::GazedView gazed;
  gazed.focal_px = 1.0 / pixel.x;
  gazed.axis_px = -low / pixel;
  gazed.gaze_px = (DVec2(math::tangent_from_direction(view.gaze.direction)) - low) / pixel;
  return metrics::gp_psnr_db(metrics::unit_from_8bit(truth), metrics::unit_from_8bit(shown), gazed);
}

Judged judge(const Viewed& viewed, const Source& source, const foveation::Display& display) {
  constexpr std::size_t kMostPictures = 6;
  Judged judged;
  if (!source.pattern || viewed.samples.empty()) return judged;
  std::array<double, 2> squares{}, counts{};
  frames::Series gp;
  const std::size_t step = std::max<std::size_t>(viewed.samples.size() / kMostPictures, 1);
  for (std::size_t i = 0; i < viewed.samples.size(); i += step) {
    const frames::DecodedFrame& frame = *viewed.samples[i];
    add_cell_errors(frame, source_picture(source, frame.begin, frame.begin.views[0].grid), squares,
                    counts);
    gp.add(gp_psnr_of(frame, source, display));
  }
  const auto db = [&](std::size_t i) {
    return -10.0 *
           std::log10(std::max(squares[i] / std::max(counts[i], 1.0), 1e-9) / (255.0 * 255.0));
  };
  judged.f10_db = db(0);
  judged.out10_db = db(1);
  judged.gp_db = gp.mean();
  return judged;
}

/// The longest time between two new frames.
double longest_stall_ms(const Viewed& viewed) {
  Nanoseconds longest{0};
  for (std::size_t i = 1; i < viewed.news.size(); ++i) {
    longest = std::max(longest, viewed.news[i] - viewed.news[i - 1]);
  }
  return units::to_ms(longest);
}

/// After an outage: until the first new frame. After a slow spell: until ages are again within a
/// fifth of what they were before it, for a second.
double recovery_ms(const Viewed& viewed, const StreamingLink& link, const LinkScript& script) {
  if (!script.trouble_ended()) return NAN;
  const ClientTime ended = *script.trouble_ended();
  if (link.slow_bytes_per_s <= 0.0) {
    const auto first = std::find_if(viewed.news.begin(), viewed.news.end(),
                                    [&](ClientTime at) { return at > ended; });
    return first == viewed.news.end() ? INFINITY : units::to_ms(*first - ended);
  }
  frames::Series before;
  for (std::size_t i = 0; i < viewed.refresh_at.size(); ++i) {
    if (viewed.refresh_at[i] < *script.trouble_began()) before.add(viewed.age_ms_by_refresh[i]);
  }
  const double good_ms = 1.2 * before.quantile(0.95);
  std::size_t good = 0;
  for (std::size_t i = 0; i < viewed.refresh_at.size(); ++i) {
    if (viewed.refresh_at[i] < ended) continue;
    good = viewed.age_ms_by_refresh[i] <= good_ms ? good + 1 : 0;
    if (good == 72) return units::to_ms(viewed.refresh_at[i - 71] - ended);
  }
  return INFINITY;
}

/// Of the slow spell, without its first two seconds.
double slow_age_p95_ms(const Viewed& viewed, const StreamingLink& link, const LinkScript& script) {
  if (link.slow_bytes_per_s <= 0.0 || !script.trouble_ended()) return NAN;
  frames::Series ages;
  for (std::size_t i = 0; i < viewed.refresh_at.size(); ++i) {
    const ClientTime at = viewed.refresh_at[i];
    if (at > *script.trouble_began() + std::chrono::seconds{2} && at < *script.trouble_ended()) {
      ages.add(viewed.age_ms_by_refresh[i]);
    }
  }
  return ages.quantile(0.95);
}

double closure_error_ms(const Viewed& viewed) {
  double most = 0.0;
  for (const auto& account : viewed.accounts) {
    most = std::max(most, std::abs(units::to_ms(account.times.total - account.times.sum())));
  }
  return most;
}

double encode_cpu_ms(const session::Telemetry& telemetry) {
  frames::Series series;
  for (const auto& frame : telemetry.recent) series.add(frame.encode_cpu_ms);
  return series.quantile(0.5);
}

/// Of frames when they are first shown; later refreshes of a slow renderer show them again, older.
double fresh_age_p95_ms(const Viewed& viewed) {
  frames::Series ages;
  for (const auto& account : viewed.accounts) ages.add(units::to_ms(account.times.total));
  return ages.quantile(0.95);
}

/// "uplink_p50_ms", "uplink_p95_ms", ... of frames when first shown.
void add_stages(const Viewed& viewed, Fields& row) {
  for (std::size_t i = 0; i < frames::kStageCount; ++i) {
    const auto stage = static_cast<frames::Stage>(i);
    frames::Series ms;
    for (const auto& account : viewed.accounts) ms.add(units::to_ms(account.times[stage]));
    const std::string name = frames::name(stage);
    row.emplace_back(name + "_p50_ms", ms.quantile(0.5));
    row.emplace_back(name + "_p95_ms", ms.quantile(0.95));
  }
}

/// The stages are a table of their own below the other figures.
void print_tables(const std::vector<Fields>& rows) {
  constexpr std::ptrdiff_t kStages = 2 * frames::kStageCount, kNames = 2;  // source and link
  std::vector<Fields> figures, stages;
  for (const Fields& row : rows) {
    figures.emplace_back(row.begin(), row.end() - kStages);
    Fields& stage = stages.emplace_back(row.begin(), row.begin() + kNames);
    stage.insert(stage.end(), row.end() - kStages, row.end());
  }
  std::fputs((table_text(figures) + "\n" + table_text(stages)).c_str(), stdout);
}

struct Run {
  Viewed viewed;
  session::Telemetry telemetry;
  net::ClientCounters network;
  std::string codec;
};

double kilobits(const Run& run) {
  return 8e-3 * static_cast<double>(run.network.bytes) / std::max(run.viewed.duration_s, 1e-3);
}

Fields row_of(const StreamingOptions& options, const StreamingLink& link, const LinkScript& script,
              const Run& run, const Judged& judged) {
  const Viewed& v = run.viewed;
  const double nominal = 2.0 * options.width_px * options.height_px;
  return {{"source", std::filesystem::path(options.source).stem().string()},
          {"link", link.name},
          {"codec", run.codec},
          {"trace",
           options.trace.empty() ? "demo" : std::filesystem::path(options.trace).stem().string()},
          {"fps", static_cast<double>(v.shown) / std::max(v.duration_s, 1e-3)},
          {"shown_pct", 100.0 * static_cast<double>(v.shown) /
                            std::max<double>(static_cast<double>(v.received), 1.0)},
          {"transit_p50_ms", v.transit_ms.quantile(0.5)},
          {"transit_p99_ms", v.transit_ms.quantile(0.99)},
          {"age_p50_ms", v.ages.pose_ms.quantile(0.5)},
          {"age_p95_ms", v.ages.pose_ms.quantile(0.95)},
          {"age_p99_ms", v.ages.pose_ms.quantile(0.99)},
          {"gaze_age_p95_ms", v.ages.gaze_ms.quantile(0.95)},
          {"kbps", kilobits(run)},
          {"bytes_per_frame", v.frame_bytes.mean()},
          {"encode_cpu_ms", encode_cpu_ms(run.telemetry)},
          {"decode_cpu_ms", v.decode_cpu_ms.quantile(0.5)},
          {"psnr_f10_db", judged.f10_db},
          {"psnr_out10_db", judged.out10_db},
          {"gp_psnr_db", judged.gp_db},
          {"closure_error_max_ms", closure_error_ms(v)},
          {"clock_error_max_ms", v.clock_error_ms.largest()},
          {"clock_bound_broken", static_cast<std::int64_t>(v.clock_bound_broken)},
          {"recovery_ms", recovery_ms(v, link, script)},
          {"slow_age_p95_ms", slow_age_p95_ms(v, link, script)},
          {"stall_max_ms", longest_stall_ms(v)},
          {"cells_pct", 100.0 * v.cells.mean() / nominal},
          {"fresh_age_p95_ms", fresh_age_p95_ms(v)},
          {"render_p95_ms", v.render_ms.quantile(0.95)},
          {"render_p50_ms", v.render_ms.quantile(0.5)},
          {"credit_wait_p50_ms", v.credit_wait_ms.quantile(0.5)}};
}

Result<pose::TraceSource> make_poses(const StreamingOptions& options) {
  if (options.trace.empty()) {
    return pose::TraceSource(pose::make_demo_trace({}), pose::AtEnd::Loop);
  }
  auto trace = pose::load_trace(options.trace);
  if (!trace) return forward(trace);
  return pose::TraceSource(std::move(*trace), pose::AtEnd::Loop);
}

Result<Fields> run_link(const StreamingOptions& options, const Source& source,
                        const StreamingLink& link) {
  const test::TemporaryFolder keys;
  const base::SteadyClock clock;
  auto poses = make_poses(options);
  if (!poses) return forward(poses);
  auto config = server_config(options, source);
  if (!config) return forward(config);
  auto server = start_server(*config, source, keys.path(), clock);
  if (!server) return forward(server);
  std::unique_ptr<support::ChaosProxy> proxy;
  if (link.has_proxy) {
    auto made = support::ChaosProxy::create((*server)->endpoint(), 1);
    if (!made) return forward(made);
    proxy = std::move(*made);
  }
  LinkScript script(link, proxy.get(), clock);
  const foveation::Display display = display_of(options);
  net::ClientEndpointOptions wire;
  wire.connect = proxy ? proxy->endpoint() : (*server)->endpoint();
  wire.key_folder = keys.path();
  wire.server_key_z85 = (*server)->public_key_z85();
  wire.hello.program = "macula-bench streaming";
  wire.hello.eyes.assign(2, display);
  wire.hello.codecs = {"jpeg", "lossless"};
  if (codec::can_decode_h264()) wire.hello.codecs.push_back("h264");
  auto endpoint = net::ClientEndpoint::create(wire, clock);
  if (!endpoint) return forward(endpoint);
  const auto rig = client_app::EyeRig::side_by_side(display, 2, Meters{0.063}, Meters{1.0});
  Progress progress(link.name, 100);
  int shown_percent = 0;
  Run run;
  run.viewed = view_stream(**endpoint, clock, rig, *poses, options.seconds, [&](double share) {
    script.at(share);
    const int percent = static_cast<int>(100.0 * share);
    progress.advance(percent - std::exchange(shown_percent, percent));
  });
  run.telemetry = (*server)->telemetry();
  run.network = (*endpoint)->counters();
  run.codec = options.codec;
  if (!run.viewed.samples.empty()) {
    constexpr const char* kNames[] = {"jpeg", "lossless", "h264"};
    run.codec = kNames[static_cast<int>(run.viewed.samples.back()->begin.slices[0].codec)];
  }
  (*server)->stop();
  Fields row = row_of(options, link, script, run, judge(run.viewed, source, display));
  add_stages(run.viewed, row);
  return row;
}

Result<std::vector<StreamingLink>> wanted_links(const StreamingOptions& options) {
  std::vector<StreamingLink> links;
  const std::vector<std::string> names = !options.links.empty() || !options.network_folder.empty()
                                             ? options.links
                                             : plain_link_names();
  for (const std::string& name : names) {
    auto link = plain_link(name);
    if (!link) return forward(link);
    links.push_back(std::move(*link));
  }
  if (options.network_folder.empty()) return links;
  auto recorded = recorded_links(options.network_folder);
  if (!recorded) return forward(recorded);
  links.insert(links.end(), std::make_move_iterator(recorded->begin()),
               std::make_move_iterator(recorded->end()));
  return links;
}

}  // namespace

void make_quick(StreamingOptions& options) {
  options.seconds = 20.0;
}

std::vector<std::string> link_names() {
  return plain_link_names();
}

Result<void> run_streaming(const StreamingOptions& options) {
  const auto links = wanted_links(options);
  if (!links) return forward(links);
  const auto source = make_source(options);
  if (!source) return forward(source);
  Report report{"streaming",
                {{"seconds", options.seconds},
                 {"width_px", std::int64_t{options.width_px}},
                 {"height_px", std::int64_t{options.height_px}},
                 {"vertical_fov_deg", options.vertical_fov_deg},
                 {"age_ms", options.age_ms},
                 {"quality", std::int64_t{options.quality}},
                 {"frame_kb", std::int64_t{options.frame_kb}},
                 {"noise_levels", options.noise_levels},
                 {"effort", options.effort},
                 {"grid", options.grid}},
                {}};
  for (const StreamingLink& link : *links) {
    auto row = run_link(options, *source, link);
    if (!row) return forward(row);
    report.rows.push_back(std::move(*row));
  }
  print_tables(report.rows);
  return options.json.empty() ? Result<void>{} : write_json(options.json, report);
}

}  // namespace macula::bench
