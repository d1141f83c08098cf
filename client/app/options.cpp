#include "client/app/options.h"

#include <CLI/CLI.hpp>
#include <charconv>
#include <map>

#include "shared/base/text.h"
#include "shared/foveation/rate.h"
#include "shared/net/keys.h"

namespace macula::client_app {
namespace {

/// The options as typed; ClientConfig holds them in units.
struct Typed {
  std::string connect = "tcp://127.0.0.1:7788", keys, display, trace, gaze, record, size, out,
              codec, rate_model, reprojection = "mesh", warp_on = "cpu";
  std::uint64_t frames = 0;
  double refresh_hz = 72.0, fov_deg = 80.0, ipd_mm = 63.0, oversampling = 0.0, connect_s = 10.0;
  int eyes = 2, picture_every = 12;
  bool fast = false, loop = false, verbose = false, doctor = false;
};

// Each option says its form and, in parentheses, its default; the library's own forms read badly.

/// A number within [low, high]; the library's own Range lets NaN pass.
auto within(double low, double high) {
  return [low, high](const std::string& text) -> std::string {
    double value = 0.0;
    const char* const end = text.data() + text.size();
    const auto parsed = std::from_chars(text.data(), end, value);
    if (parsed.ec == std::errc{} && parsed.ptr == end && value >= low && value <= high) return {};
    return base::concat("'", text, "' is not a number from ", low, " to ", high);
  };
}

void add_server_options(CLI::App& app, Typed& typed) {
  app.option_defaults()->group("The server");
  app.add_option("--connect", typed.connect, "Where the server is")
      ->option_text("ENDPOINT (tcp://127.0.0.1:7788)");
  app.add_option("--connect-patience", typed.connect_s, "How long to wait for its welcome")
      ->option_text("SECONDS (10)")
      ->check(within(0.1, 3600.0));
  app.add_option("--keys", typed.keys, "Key folder")->option_text("DIR ($XDG_CONFIG_HOME/macula)");
  app.add_flag("--doctor", typed.doctor,
               "Examine keys, connection, version, stream, clock and graphics, say what to do "
               "about what does not work, and end");
  app.add_option("--codec", typed.codec, "Colour codec to ask for")
      ->option_text("auto|jpeg|h264|lossless (the server's)")
      ->check(CLI::IsMember({"auto", "jpeg", "h264", "lossless"}));
  app.add_option("--oversampling", typed.oversampling, "Cells per display pixel at the gaze")
      ->option_text("1|1.5|2|3|4")
      ->check(CLI::IsMember(std::vector<double>{1.0, 1.5, 2.0, 3.0, 4.0}));
  app.add_option("--rate-model", typed.rate_model,
                 "How sampling falls off from the gaze; an unknown name lists them")
      ->option_text("NAME");
}

void add_viewer_options(CLI::App& app, Typed& typed) {
  app.option_defaults()->group("Head and gaze");
  app.add_option("--trace", typed.trace,
                 "Head and gaze: t_s,px,py,pz,qx,qy,qz,qw,gx,gy,gz. Without one: mouse and keys in "
                 "a window, else a demo trace")
      ->option_text("FILE.csv");
  app.add_option("--gaze", typed.gaze,
                 "Where the gaze comes from, whatever moves the head; target: eyes that follow a "
                 "moving point; udp: one JSON line a packet (README)")
      ->option_text("mouse|trace|target|udp://HOST:PORT (with the head)");
  app.add_option("--record", typed.record, "Write head and gaze as a trace for --trace")
      ->option_text("FILE.csv");
  app.add_flag("--loop", typed.loop, "Start the trace again when it ends");
  app.add_option("--frames", typed.frames, "Stop after N shown frames")
      ->option_text("N (when the trace ends)");
  app.add_flag("--as-fast-as-possible", typed.fast,
               "Every refresh waits for a new server frame instead of for the clock; poses still "
               "advance one refresh period each");
}

void add_display_options(CLI::App& app, Typed& typed) {
  app.option_defaults()->group("Display");
  app.add_option("--display", typed.display, "Where the picture goes")
      ->option_text("window|openxr|headless (window where there is one)")
      ->check(CLI::IsMember({"window", "openxr", "headless"}));
  app.add_option("--size", typed.size, "Pixels of one eye")
      ->option_text("WxH (640x640; openxr: what the headset recommends)");
  app.add_option("--fov-deg", typed.fov_deg, "Vertical field of view of one eye, 5 to 150")
      ->option_text("DEGREES (80)")
      ->check(within(5.0, 150.0));
  app.add_option("--eyes", typed.eyes, "How many are rendered")
      ->option_text("1|2 (2)")
      ->check(CLI::Range(1, 2));
  app.add_option("--ipd-mm", typed.ipd_mm, "Distance between the eyes, 0 to 100")
      ->option_text("MM (63)")
      ->check(within(0.0, 100.0));
  app.add_option("--refresh", typed.refresh_hz, "Refreshes a second, 1 to 1000")
      ->option_text("HZ (72)")
      ->check(within(1.0, 1000.0));
  app.add_option("--reprojection", typed.reprojection,
                 "How the newest frame is brought to the display's pose; grid is a coarser mesh "
                 "for slow machines")
      ->option_text("mesh|grid|rotation|stale (mesh)")
      ->check(CLI::IsMember({"mesh", "grid", "rotation", "stale"}));
  app.add_option("--warp", typed.warp_on,
                 "What brings it there: the processor, or the window's OpenGL 3.3")
      ->option_text("cpu|gl (cpu)")
      ->check(CLI::IsMember({"cpu", "gl"}));
  app.add_option("--out", typed.out, "Folder for pictures, report.json and frames.csv")
      ->option_text("DIR (headless: macula-out)");
  app.add_option("--picture-every", typed.picture_every, "Write every Nth shown frame as PNG")
      ->option_text("N (12)")
      ->check(CLI::Range(1, 1'000'000));
  app.add_flag("--verbose", typed.verbose, "Tell more");
  app.option_defaults()->group("Options");
}

CLI::App* add_pair_command(CLI::App& app, PairCommand& pair) {
  CLI::App* const command = app.add_subcommand(
      "pair", "Get to know a server by the code that 'macula-server pair' shows there");
  command->add_option("--connect", pair.connect, "Where it pairs; it prints the address")
      ->option_text("ENDPOINT (tcp://127.0.0.1:7789)");
  command->add_option("--code", pair.code, "The six digits; without it, they are asked for")
      ->option_text("DIGITS");
  command->add_option("--name", pair.name, "What the server calls this client")
      ->option_text("NAME (the machine's)");
  return command;
}

/// "WxH", both within 16..8192.
Result<std::pair<int, int>> parse_size(const std::string& text) {
  int width = 0, height = 0;
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, width);
  const bool has_x = first.ec == std::errc{} && first.ptr != end && *first.ptr == 'x';
  const auto second = has_x ? std::from_chars(first.ptr + 1, end, height) : first;
  const auto in_range = [](int side) { return side >= 16 && side <= 8192; };
  if (!has_x || second.ec != std::errc{} || second.ptr != end || !in_range(width) ||
      !in_range(height)) {
    return base::bad_input(base::concat("'", text, "' is not a size"), "--size",
                           "WxH with 16 to 8192 pixels a side, such as 640x640");
  }
  return std::pair{width, height};
}

/// A headset knows its own size; other displays keep the default.
Result<void> choose_size(const std::string& text, ClientConfig& config) {
  if (text.empty()) {
    if (config.display == DisplayKind::OpenXr) config.width_px = config.height_px = 0;
    return {};
  }
  const auto size = parse_size(text);
  if (!size) return base::forward(size);
  std::tie(config.width_px, config.height_px) = *size;
  return {};
}

/// What a headset decides must not be asked for.
Result<void> check_headset_options(const CLI::App& app) {
  for (const char* option :
       {"--trace", "--as-fast-as-possible", "--fov-deg", "--eyes", "--ipd-mm", "--refresh"}) {
    if (app.count(option) > 0)
      return base::bad_input("the headset itself decides this", option,
                             "leave it out with --display openxr");
  }
  return {};
}

DisplayKind display_kind(const Typed& typed, const Environment& environment) {
  if (typed.display == "window") return DisplayKind::Window;
  if (typed.display == "openxr") return DisplayKind::OpenXr;
  if (typed.display == "headless") return DisplayKind::Headless;
  const auto is_set = [](const char* value) { return value != nullptr && *value != '\0'; };
  return is_set(environment.display) || is_set(environment.wayland_display) ? DisplayKind::Window
                                                                            : DisplayKind::Headless;
}

ClientConfig::Warp warp_of(const std::string& name) {
  using Warp = ClientConfig::Warp;
  static const std::map<std::string, Warp> kWarps = {{"mesh", Warp::Mesh},
                                                     {"grid", Warp::Grid},
                                                     {"rotation", Warp::Rotation},
                                                     {"stale", Warp::Stale}};
  return kWarps.at(name);
}

std::string key_folder(const Typed& typed, const Environment& environment) {
  return typed.keys.empty() ? net::default_key_folder(environment.xdg_config_home, environment.home)
                            : typed.keys;
}

Result<void> choose_gaze(const Typed& typed, ClientConfig& config) {
  using GazeFrom = ClientConfig::GazeFrom;
  constexpr std::string_view kUdp = "udp://";
  const std::string& text = typed.gaze;
  if (text.empty() || (text == "trace" && !typed.trace.empty())) return {};
  if (text == "trace")
    return base::bad_input("there is no trace to take the gaze from", "--gaze trace",
                           "name one with --trace");
  if (text == "mouse" && config.display != DisplayKind::Window)
    return base::bad_input("there is no window to take the mouse from", "--gaze mouse",
                           "use --display window");
  if (text == "mouse") {
    config.gaze = GazeFrom::Mouse;
  } else if (text == "target") {
    config.gaze = GazeFrom::Target;
  } else if (text.starts_with(kUdp)) {
    config.gaze = GazeFrom::Udp;
    config.gaze_address = text.substr(kUdp.size());
  } else {
    return base::bad_input(base::concat("'", text, "' is no source of a gaze"), "--gaze",
                           "mouse, trace, target or udp://HOST:PORT");
  }
  return {};
}

Result<void> choose_warp(const Typed& typed, ClientConfig& config) {
  config.warp = warp_of(typed.reprojection);
  if (typed.warp_on == "gl" && config.display != DisplayKind::Window)
    return base::bad_input("there is no window whose OpenGL could warp", "--warp gl",
                           "use --display window, or --warp cpu");
  config.warp_on = typed.warp_on == "gl" ? ClientConfig::WarpOn::Gl : ClientConfig::WarpOn::Cpu;
  return {};
}

Result<Options> make_options(const Typed& typed, const Environment& environment) {
  Options options;
  ClientConfig& config = options.config;
  config.display = display_kind(typed, environment);
  if (auto done = choose_size(typed.size, config); !done) return base::forward(done);
  if (!typed.rate_model.empty()) {
    if (const auto model = foveation::find_rate_model(typed.rate_model); !model) {
      Error error = model.error();
      error.where = "--rate-model";
      return tl::unexpected(std::move(error));
    }
  }
  config.connect = typed.connect;
  config.connect_patience = units::from_s(typed.connect_s);
  config.key_folder = key_folder(typed, environment);
  config.vertical_fov = Degrees{typed.fov_deg};
  config.eyes = typed.eyes;
  config.ipd = Meters{1e-3 * typed.ipd_mm};
  config.refresh_hz = typed.refresh_hz;
  config.pacing = typed.fast ? Pacing::AsFastAsPossible : Pacing::RealTime;
  if (auto done = choose_warp(typed, config); !done) return base::forward(done);
  config.trace_file = typed.trace;
  config.record_file = typed.record;
  if (auto done = choose_gaze(typed, config); !done) return base::forward(done);
  config.repeat_trace = typed.loop ? ClientConfig::Repeat::Yes : ClientConfig::Repeat::No;
  config.frames = typed.frames;
  config.settings.color_codec = typed.codec == "auto" ? "" : typed.codec;
  config.settings.fovea_oversampling = typed.oversampling;
  config.settings.rate_model = typed.rate_model;
  const bool headless = config.display == DisplayKind::Headless;
  config.out_folder = typed.out.empty() && headless ? "macula-out" : typed.out;
  config.picture_every = typed.picture_every;
  options.task = typed.doctor ? Task::Examine : Task::Show;
  options.verbosity = typed.verbose ? Verbosity::Verbose : Verbosity::Normal;
  return options;
}

}  // namespace

Result<Command> parse_options(int argc, const char* const* argv, const Environment& environment) {
  Typed typed;
  PairCommand pair{"tcp://127.0.0.1:7789", {}, {}, {}};
  CLI::App app(
      "macula-client: shows what macula-server renders, warped to where the head is now.\n"
      "In a window the cursor is your gaze, dragging turns your head and W A S D move it; H lists "
      "the keys.\n"
      "--display openxr shows it in the headset of the running OpenXR runtime.",
      "macula-client");
  app.set_version_flag("--version", "macula-client 0.1.0");
  add_server_options(app, typed);
  add_viewer_options(app, typed);
  add_display_options(app, typed);
  app.fallthrough();
  const CLI::App* const pairing = add_pair_command(app, pair);
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    return TextAsked{app.help()};
  } catch (const CLI::CallForVersion&) {
    return TextAsked{app.version() + "\n"};
  } catch (const CLI::Error& error) {
    return base::bad_input(error.what(), "command line", "see macula-client --help");
  }
  if (pairing->parsed()) {
    pair.key_folder = key_folder(typed, environment);
    return pair;
  }
  auto options = make_options(typed, environment);
  if (!options) return base::forward(options);
  if (options->config.display == DisplayKind::OpenXr) {
    if (auto done = check_headset_options(app); !done) return base::forward(done);
  }
  return std::move(*options);
}

}  // namespace macula::client_app
