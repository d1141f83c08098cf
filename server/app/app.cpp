#include "server/app/app.h"

#include <ctime>
#include <iomanip>
#include <iostream>
#include <memory>
#include <random>
#include <vector>

#include "server/app/kernel_ladder.h"
#include "server/app/ranks.h"
#include "server/exporter/exporter.h"
#include "server/kernels/registry.h"
#include "server/kernels/scene_timeline.h"
#include "server/kernels/vpl/virtual_lights.h"
#include "server/scene/load.h"
#include "server/scene/plan.h"
#include "server/session/recording.h"
#include "server/session/server.h"
#include "shared/base/log.h"
#include "shared/base/resident.h"
#include "shared/base/text.h"
#include "shared/math/hash.h"
#include "shared/net/keys.h"
#include "shared/net/listener.h"

namespace macula::server_app {
namespace {

using SceneTable = std::shared_ptr<const scene::Scene>;

void print_scenes() {
  for (const scene::SceneName& entry : scene::scene_names())
    std::cout << entry.name << "\t" << entry.summary << "\n";
}

/// A scene and everything decided from it.
struct PlannedScene {
  SceneTable scene;
  scene::SceneFacts facts;
  scene::ScenePlan plan;
  scene::KernelChoice kernel;
};

scene::KernelChoice resolve_kernel(const Options& options, const scene::SceneFacts& facts) {
  if (options.kernel != "auto") return {options.kernel, "asked for"};
  std::vector<std::string_view> registered;
  for (const kernels::KernelEntry& entry : kernels::kernel_table())
    registered.push_back(entry.name);
  return scene::choose_kernel(facts, scene::IndirectLight::NotWanted, registered);
}

PlannedScene plan_scene(const Options& options, SceneTable scene) {
  const scene::SceneFacts facts = scene::facts_of(*scene);
  scene::KernelChoice kernel = resolve_kernel(options, facts);
  const scene::Wishes wishes{.ambient_samples = options.ambient_samples, .kernel = kernel.kernel};
  return {std::move(scene), facts, scene::ScenePlan(facts, wishes), std::move(kernel)};
}

/// What was asked for beyond what the scene needs comes in with the plan's row.
scene::PlannedStep with_bounced(scene::PlannedStep step, const Options& options) {
  if (step.step != scene::Step::VirtualLights || options.bounced_rays == 0) return step;
  step.use = scene::StepUse::Used;
  step.reason = base::concat("light that surfaces have reflected once, of ", options.bounced_rays,
                             " rays at most, in the light tree");
  return step;
}

void print_plan(const PlannedScene& planned, const Options& options) {
  std::cout << "kernel " << planned.kernel.kernel << ": " << planned.kernel.reason << "\n";
  for (const scene::PlannedStep& planned_step : planned.plan.steps()) {
    const scene::PlannedStep step = with_bounced(planned_step, options);
    const bool used = step.use != scene::StepUse::LeftOut;
    std::cout << (used ? "  used      " : "  left out  ") << step.name << ": " << step.reason
              << "\n";
  }
}

void print_assumptions(const scene::Scene& scene) {
  for (const std::string& guess : scene.settings.guesses) std::cout << "assumed: " << guess << "\n";
  for (const std::string& warning : scene.warnings) std::cout << "warning: " << warning << "\n";
}

std::string one_line(std::string text) {
  for (char& c : text)
    if (c == '\n') c = ';';
  return text;
}

session::ServerConfig server_config(const Options& options, const PlannedScene& planned,
                                    const Ladder& ladder) {
  const scene::Scene& scene = *planned.scene;
  const scene::SceneFacts& facts = planned.facts;
  session::ServerConfig config;
  config.offer.kernel = planned.kernel.kernel;
  config.offer.default_codec = options.codec;
  config.offer.scene = {scene.name, facts.triangles, facts.lights + facts.emissive_triangles,
                        scene.settings.scene_from_stage};
  config.views.scene_from_stage = scene.settings.scene_from_stage;
  config.views.tone = scene.settings.tone;
  config.views.rate_model = *foveation::find_rate_model(options.rate_model);
  config.views.fovea_oversampling = options.oversampling;
  config.views.guard_band = Degrees{options.guard_deg};
  config.rules.longest_horizon = units::from_ms(options.predict_ms);
  if (options.predict_ms > 0.0) {
    config.rules.most_guard_band = Degrees{15.0};
    config.rules.most_view_cell_m = 0.01 * options.view_cell_cm;
  }
  config.jpeg_quality = options.color_quality;
  config.ladder = ladder.steps, config.ladder_kernels = ladder.kernels;
  config.reference = ladder.reference;
  config.quality = options.quality, config.most_rmse = options.max_error;
  if (options.age_ms > 0.0) config.age_goal = units::from_ms(options.age_ms);
  if (options.target_ms) config.target_frame_time = units::from_ms(*options.target_ms);
  Options told = options;
  told.ladders.clear();
  told.keys.clear();  // travels in frames; where keys lie is nobody's business
  told.threads = 0;   // makes no difference to any frame
  told.metrics.clear();
  told.balance = Options{}.balance;
  told.rank_timeout_ms = Options{}.rank_timeout_ms;
  config.description = one_line(describe(told));
  return config;
}

session::SessionTable::RandomBits system_random() {
  return [device = std::make_shared<std::random_device>()] {
    return static_cast<std::uint64_t>((*device)()) << 32 | (*device)();
  };
}

Result<std::unique_ptr<net::ServerEndpoint>> open_endpoint(const Options& options,
                                                           const base::Clock& clock) {
  if (const auto keys = net::load_or_make_keys(options.keys, net::Role::Server); !keys)
    return base::forward(keys);
  net::ServerEndpointOptions endpoint;
  endpoint.bind = options.bind;
  endpoint.key_folder = options.keys;
  return net::ServerEndpoint::create(endpoint, clock);
}

/// A server that other machines can reach, but may not use yet, says what is missing.
void print_reach(const std::string& endpoint, const std::string& key_folder) {
  if (!net::is_beyond_loopback(endpoint) || !net::list_clients(key_folder).empty()) return;
  std::cout << "note: no client of another machine is allowed yet; run 'macula-server pair --keys "
            << key_folder << "' beside this server, then 'macula-client pair' there\n";
}

/// What the scene has cost so far: reading it, and building what the plan asks for.
void print_cost() {
  std::cout << std::fixed << std::setprecision(1) << "scene ready after "
            << static_cast<double>(std::clock()) / CLOCKS_PER_SEC << " s of processor time, "
            << 1e-6 * static_cast<double>(base::resident_bytes()) << " MB resident\n"
            << std::defaultfloat;
}

/// Serves until a signal comes or, of several ranks, one is lost.
Result<void> serve(session::Server& server, const exporter::Exporter* exporter,
                   const Options& options, const Ranks& ranks, StopSignal& stop) {
  constexpr std::chrono::milliseconds kLook{100}, kReport{5000};
  server.start();
  stop.serving();
  print_cost();
  if (exporter) std::cout << "metrics on port " << exporter->port() << "\n";
  print_reach(server.endpoint(), options.keys);
  std::cout << "ready on " << server.endpoint() << " public key " << server.public_key_z85()
            << std::endl;
  auto report_at = std::chrono::steady_clock::now() + kReport;
  while (!stop.wait_for(ranks ? kLook : kReport)) {
    if (ranks && !ranks->lost().empty()) {
      server.stop("a part of the server was lost: " + ranks->lost() + "; it starts again");
      // MPI ends all ranks as soon as this one lets go of them: there is no later to speak.
      std::cerr << "macula-server: cluster: " << ranks->lost() << "\n";
      return base::runtime_error(ranks->lost(), "cluster", "the launcher may start it again");
    }
    if (std::chrono::steady_clock::now() < report_at) continue;
    report_at += kReport;
    if (options.verbose) base::log_info(session::summary_line(server.telemetry()));
  }
  server.stop();
  return {};
}

/// What frames are made with, but for the scene.
struct Prepared {
  std::shared_ptr<const kernels::Kernel> kernel;
  Ladder ladder;

  KernelList kernels() const {
    KernelList all = ladder.kernels;
    all.push_back(kernel);
    return all;
  }
  void share(const std::shared_ptr<cluster::Leader>& leader) {
    ladder.kernels = shared_by_ranks(kernels(), leader);
    kernel = ladder.kernels.back();
    ladder.kernels.pop_back();
  }
};

/// nullptr: this process is alone.
std::shared_ptr<cluster::Leader> make_leader(const Options& options, const Ranks& ranks) {
  return ranks ? std::make_shared<cluster::Leader>(ranks, balance_of(options)) : nullptr;
}

/// With bounced light where it was asked for. Every rank finds the same by itself.
Result<std::shared_ptr<kernels::SceneTimeline>> make_timeline(const Options& options,
                                                              const PlannedScene& planned) {
  if (options.bounced_rays == 0) return kernels::SceneTimeline::create(planned.scene, planned.plan);
  const auto scheduler = std::make_shared<scheduling::TileScheduler>(options.threads);
  const auto rays = static_cast<std::size_t>(options.bounced_rays);
  return kernels::SceneTimeline::create(
      planned.scene, planned.plan, [scheduler, rays](const kernels::SceneFrame& frame) {
        const kernels::vpl::Config config = kernels::vpl::shared_out(frame, rays);
        return kernels::vpl::make_virtual_lights(frame, config, *scheduler).lights;
      });
}

/// Makes a recording's frames again; the same scene, kernel and options give the same bytes.
Result<void> replay_scene(const Options& options, const PlannedScene& planned, Prepared prepared) {
  const Ladder& ladder = prepared.ladder;
  const auto recording = session::load_recording(options.replay);
  if (!recording) return base::forward(recording);
  auto timeline = make_timeline(options, planned);
  if (!timeline) return base::forward(timeline);
  const session::ServerConfig config = server_config(options, planned, ladder);
  if (recording->description != config.description)
    std::cout << "recorded with: " << recording->description << "\n";
  std::uint64_t all = 0;
  const auto print = [&](const session::ReplayedFrame& frame) {
    all = math::hash_combine(all, frame.digest);
    std::cout << "frame " << frame.key.frame << "  " << frame.bytes << " bytes  " << std::hex
              << std::setw(16) << std::setfill('0') << frame.digest << std::dec << "\n";
  };
  const auto done = session::replay(*recording, config, std::move(*timeline), prepared.kernel,
                                    options.threads, print);
  if (!done) return done;
  std::cout << recording->frames.size() << " frames, digest " << std::hex << std::setw(16)
            << std::setfill('0') << all << std::dec << std::endl;
  return {};
}

Result<void> serve_scene(const Options& options, const PlannedScene& planned, Prepared prepared,
                         const Ranks& ranks, StopSignal& stop) {
  const base::SteadyClock clock;
  auto endpoint = open_endpoint(options, clock);
  if (!endpoint) return base::forward(endpoint);
  auto timeline = make_timeline(options, planned);
  if (!timeline) return base::forward(timeline);
  session::ServerParts parts;
  parts.endpoint = std::move(*endpoint);
  parts.scene = std::move(*timeline);
  const auto leader = make_leader(options, ranks);
  if (leader) prepared.share(leader);
  parts.kernel = prepared.kernel;
  parts.scheduler = std::make_shared<scheduling::TileScheduler>(options.threads);
  parts.clock = &clock;
  parts.random = system_random();
  session::ServerConfig config = server_config(options, planned, prepared.ladder);
  if (!options.record.empty()) {
    auto recorder = session::Recorder::create(options.record, config.description);
    if (!recorder) return base::forward(recorder);
    parts.recorder = std::move(*recorder);
  }
  if (!options.report.empty()) {
    auto log = session::FrameLog::create(options.report);
    if (!log) return base::forward(log);
    parts.log = std::move(*log);
  }
  auto server = session::Server::create(std::move(config), std::move(parts));
  if (!server) return base::forward(server);
  std::unique_ptr<exporter::Exporter> exporter;  // goes before the server it reads
  if (!options.metrics.empty()) {
    auto made = exporter::Exporter::create(options.metrics,
                                           [&reported = **server] { return reported.telemetry(); });
    if (!made) return base::forward(made);
    exporter = std::move(*made);
  }
  auto served = serve(**server, exporter.get(), options, ranks, stop);
  if (leader) leader->end();
  return served;
}

/// A rank that is not the first: makes what that one orders until it ends.
Result<void> follow_scene(const Options& options, const PlannedScene& planned,
                          const Prepared& prepared, cluster::MpiRanks& ranks, StopSignal& stop) {
  auto timeline = make_timeline(options, planned);
  if (!timeline) return base::forward(timeline);
  scheduling::TileScheduler scheduler(options.threads);
  stop.serving();  // signals are rank 0's to answer; it will say when to end
  const KernelList kernels = prepared.kernels();
  return cluster::follow(ranks, {kernels, **timeline, scheduler, balance_of(options)});
}

/// All that has to be the same on every rank.
std::string agreed(const Options& options, const PlannedScene& planned) {
  Options same = options;
  same.bind.clear(), same.keys.clear(), same.metrics.clear(), same.ladders.clear();
  same.threads = 0, same.verbose = false;
  return base::concat("version " MACULA_VERSION "\nscene ", planned.scene->name, ", ",
                      planned.facts.triangles, " triangles, ", planned.facts.lights, " lights, ",
                      planned.facts.emissive_triangles, " emissive triangles\n", describe(same));
}

}  // namespace

namespace {

struct Loaded {
  PlannedScene planned;
  Prepared prepared;
};

Result<Loaded> load(const Options& options, const Environment& environment) {
  auto scene = scene::load_scene(options.scene);
  if (!scene) return base::forward(scene);
  PlannedScene planned = plan_scene(options, std::move(*scene));
  if (auto ok = kernels::check_scene(planned.kernel.kernel, *planned.scene); !ok)
    return base::forward(ok);
  const std::string name(planned.kernel.kernel);
  if (options.bounced_rays > 0 && name != "lightcuts")
    return base::bad_input(base::concat("kernel '", name, "' asks no such lights"),
                           "--bounced-rays", "kernel lightcuts, or 0");
  auto kernel = choose_kernel(options, name);
  if (!kernel) return base::forward(kernel);
  auto ladder = load_ladder(options, environment.installed_ladders, name);
  if (!ladder) return base::forward(ladder);
  return Loaded{std::move(planned), {std::move(*kernel), std::move(*ladder)}};
}

void print_all(const Options& options, const Loaded& loaded, const Ranks& ranks) {
  std::cout << describe(options);
  if (ranks) std::cout << "frames are made by " << ranks->size() << " ranks\n";
  print_assumptions(*loaded.planned.scene);
  print_plan(loaded.planned, options);
  print_ladder(loaded.prepared.ladder, options);
}

}  // namespace

Result<void> run(Options options, const Environment& environment, StopSignal& stop) {
  base::set_log_level(options.verbose ? base::LogLevel::Info : base::LogLevel::Warning);
  if (options.list_scenes) {
    print_scenes();
    return {};
  }
  if (options.keys.empty()) options.keys = environment.default_key_folder;
  const auto ranks = join_ranks(options, environment);
  if (!ranks) return base::forward(ranks);
  const bool follows = *ranks && (*ranks)->rank() != 0;
  if (follows) std::cout.setstate(std::ios::failbit);  // rank 0 speaks for all
  auto loaded = load(options, environment);
  const Result<void> good = loaded ? Result<void>{} : Result<void>(base::forward(loaded));
  if (*ranks) {
    const auto agreement = agree(**ranks, good, loaded ? agreed(options, loaded->planned) : "");
    if (!agreement) return agreement;
  }
  if (!good) return good;
  if (!follows) print_all(options, *loaded, *ranks);
  if (options.explain) return {};
  std::cout << std::flush;
  if (!options.replay.empty())
    return follows ? Result<void>{}
                   : replay_scene(options, loaded->planned, std::move(loaded->prepared));
  if (follows) return follow_scene(options, loaded->planned, loaded->prepared, **ranks, stop);
  return serve_scene(options, loaded->planned, std::move(loaded->prepared), *ranks, stop);
}

}  // namespace macula::server_app
