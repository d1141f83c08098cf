#include "client/app/doctor.h"

#include <cmath>
#include <iomanip>
#include <ostream>

#include "client/app/connect.h"
#include "client/app/eye_rig.h"
#include "client/app/screen.h"
#include "client/display/window/hidden_context.h"
#include "shared/base/log.h"
#include "shared/base/text.h"
#include "shared/net/client_endpoint.h"
#include "shared/net/keys.h"

namespace macula::client_app {
namespace {

using base::concat;
using Verdict = Finding::Verdict;
using namespace std::chrono_literals;

constexpr auto kTrial = 3s;
constexpr Nanoseconds kPatience = 5s;
/// Below these a person sees it (RELIABILITY and REPROJECTION notes: 100 ms of latency are hidden).
constexpr double kFewFrames_hz = 10.0, kLongRoundTrip_ms = 50.0, kBadClock_ms = 20.0;

/// Prints findings as they are made.
class Report {
 public:
  explicit Report(std::ostream& out) : out_(out) {}
  void add(const Finding& finding) {
    constexpr const char* kMarks[] = {"ok  ", "note", "BAD "};
    out_ << kMarks[static_cast<int>(finding.verdict)] << "  " << std::left << std::setw(10)
         << finding.subject << finding.text << std::endl;
    is_well_ = is_well_ && finding.verdict != Verdict::Bad;
  }
  void good(const std::string& subject, const std::string& text) {
    add({Verdict::Good, subject, text});
  }
  void bad(const std::string& subject, const Error& error) {
    add({Verdict::Bad, subject, error.message()});
  }
  bool is_well() const { return is_well_; }

 private:
  std::ostream& out_;
  bool is_well_ = true;
};

bool examine_keys(const ClientConfig& config, Report& report) {
  const auto own = net::load_or_make_keys(config.key_folder, net::Role::Client);
  if (!own) {
    report.bad("keys", own.error());
    return false;
  }
  report.good("keys", concat("this client is ", own->public_z85, " in ", config.key_folder));
  const auto server = net::load_public_key(config.key_folder + "/server.pub");
  if (server) {
    report.good("server", concat("known by the key ", *server));
    return true;
  }
  Error error = server.error();
  error.remedy = "run 'macula-server pair' on its machine and 'macula-client pair' here";
  report.bad("server", error);
  return false;
}

StreamTrial try_stream(const ClientConfig& config, net::ClientEndpoint& endpoint,
                       const base::Clock& clock, const std::atomic<bool>& stop) {
  const EyeRig rig = eye_rig(config);
  const Nanoseconds begin = clock.now();
  StreamTrial trial;
  for (std::uint64_t sequence = 1; clock.now() - begin < kTrial && !stop; ++sequence) {
    net::ViewState view = rig.view_state({}, {});
    view.sequence = sequence;
    view.sampled = view.gaze_sampled = view.predicted_display = ClientTime{clock.now()};
    endpoint.publish(std::move(view));
    if (endpoint.wait_frame(units::from_s(1.0 / config.refresh_hz))) ++trial.frames;
    if (const auto estimate = endpoint.clock()) trial.clock = estimate;
  }
  trial.lasted = clock.now() - begin;
  trial.bytes = endpoint.counters().bytes;
  endpoint.send(net::Bye{"examined", 0});
  return trial;
}

void examine_stream(const ClientConfig& config, const base::Clock& clock,
                    const std::atomic<bool>& stop, Report& report) {
  net::ClientEndpointOptions options;
  options.connect = config.connect;
  options.key_folder = config.key_folder;
  options.hello = make_hello(config, eye_rig(config), config.refresh_hz);
  auto endpoint = net::ClientEndpoint::create(options, clock);
  if (!endpoint) return report.bad("connection", endpoint.error());
  const auto welcome = wait_for_welcome(**endpoint, clock, config.connect, kPatience, stop);
  if (!welcome) return report.bad("connection", welcome.error());
  report.good("connection", concat("welcomed by ", config.connect, ", protocol version ",
                                   welcome->protocol_version));
  report.good("scene", concat(welcome->scene.name, ", ", welcome->scene.triangles, " triangles, ",
                              welcome->scene.lights, " lights, kernel ", welcome->kernel,
                              ", colour ", welcome->color_codec));
  for (const Finding& finding : judge(try_stream(config, **endpoint, clock, stop)))
    report.add(finding);
}

void examine_graphics(const ClientConfig& config, const base::Clock& clock, Report& report) {
  if (config.display == DisplayKind::Headless)
    return report.good("display", "headless: pictures are written, nothing is shown");
  if (config.display == DisplayKind::Window) {
    if (const auto context = display::HiddenContext::create(); !context)
      return report.bad("graphics", context.error());
    return report.good("graphics", "OpenGL 3.3 works here");
  }
  const auto screen = make_screen(config, clock);
  if (!screen) return report.bad("headset", screen.error());
  report.good("headset", concat("runs at ", (*screen)->refresh_hz(), " Hz"));
}

Finding judge_frames(const StreamTrial& trial) {
  const double seconds = units::to_s(trial.lasted);
  if (trial.frames == 0)
    return {Verdict::Bad, "frames",
            concat("none came in ", seconds,
                   " s: is the server's machine busy, or a firewall in the way of large packets?")};
  const double rate = static_cast<double>(trial.frames) / seconds;
  const double mbit_s = 8e-6 * static_cast<double>(trial.bytes) / seconds;
  const std::string found = concat(std::round(10.0 * rate) / 10.0, " a second, ",
                                   std::round(10.0 * mbit_s) / 10.0, " Mbit/s");
  if (rate >= kFewFrames_hz) return {Verdict::Good, "frames", found};
  return {Verdict::Note, "frames",
          found + "; more come with macula-server --target-ms, fewer samples, or a smaller --size"};
}

Finding judge_clock(const StreamTrial& trial) {
  if (!trial.clock)
    return {Verdict::Bad, "clock", "the server answers no Ping: check the connection"};
  const double rtt_ms = units::to_ms(trial.clock->min_rtt);
  const double bound_ms = units::to_ms(trial.clock->bound);
  const std::string found =
      concat("round trip ", rtt_ms, " ms, the server's time known to ", bound_ms, " ms");
  if (rtt_ms > kLongRoundTrip_ms)
    return {Verdict::Note, "clock", found + "; turns of the head will show it: use a nearer link"};
  if (bound_ms > kBadClock_ms)
    return {Verdict::Note, "clock", found + "; ages of frames are told no better than that"};
  return {Verdict::Good, "clock", found};
}

}  // namespace

std::vector<Finding> judge(const StreamTrial& trial) {
  return {judge_frames(trial), judge_clock(trial)};
}

bool run_doctor(const ClientConfig& config, const base::Clock& clock, const std::atomic<bool>& stop,
                std::ostream& out) {
  base::set_log_level(base::LogLevel::Error);
  Report report(out);
  if (examine_keys(config, report)) examine_stream(config, clock, stop, report);
  examine_graphics(config, clock, report);
  out << (report.is_well() ? "all is well\n" : "see the lines marked BAD\n");
  return report.is_well();
}

}  // namespace macula::client_app
