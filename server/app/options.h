// The options of macula-server: from the command line over a settings file over the defaults here.
// Parsed once; everyone else receives structs.
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "shared/base/result.h"

namespace macula::server_app {

struct Options {
  std::string scene = "cornell";              ///< built-in name or file
  std::string kernel = "auto";                ///< auto or a registered name
  std::string bind = "tcp://127.0.0.1:7788";  ///< port 0 picks a free one
  std::string keys;                           ///< folder; empty: the user's own
  std::optional<double> target_ms;            ///< render time the governor holds; none: any
  std::optional<double> quality;    ///< 0..10 on the kernel's ladder; none: its own settings
  std::optional<double> max_error;  ///< RMSE that quality never goes beyond; none: any
  std::string ladders;              ///< folder of quality ladders; empty: those installed
  std::string config;               ///< settings file, TOML
  std::string rate_model = "cortical";
  double oversampling = 1.0;   ///< cells per display pixel at the gaze
  double guard_deg = 4.0;      ///< rendered beyond the display on every side, 0..15
  double predict_ms = 0.0;     ///< how far ahead of a view's head frames may be rendered; 0: not
  double view_cell_cm = 5.0;   ///< how far eyes may move for the second layer; 0: no such layer
  double age_ms = 100.0;       ///< how old frames may be shown on a slow link; 0: any age
  int color_quality = 85;      ///< on JPEG's scale, 1..100
  std::string codec = "auto";  ///< auto, jpeg, h264 or lossless
  int area_samples = 8;        ///< per primary sample, over all emissive triangles
  int ambient_samples = 4;     ///< per primary sample
  std::string knobs;           ///< "name=value ..." of the kernel, over the other options
  int threads = 0;             ///< 0: every core; of each rank
  std::string balance = "predicted";  ///< who runs which tile where there are several ranks
  int rank_timeout_ms = 5000;         ///< a rank that lags so far behind the others is lost
  bool reuse = false;  ///< kernel ray takes cells from earlier frames where they still hold
  bool perceived_lights = false;  ///< kernel lightcuts asks as many lights as the eye would see
  int bounced_rays = 0;           ///< kernel lightcuts: virtual lights made of so many; 0: none
  std::string record;             ///< file that what arrives is written to; empty: none
  std::string report;             ///< folder for what became of each frame; empty: nowhere
  std::string replay;             ///< recording to make again instead of serving; empty: serve
  std::string metrics;            ///< ADDRESS:PORT that Prometheus may read; empty: none
  bool explain = false, list_scenes = false, verbose = false;
};

/// What to print instead of serving: the help text or the version.
struct PrintAndExit {
  std::string text;
};

/// 'macula-server pair': let one client in by a code.
struct PairCommand {
  std::string keys;  ///< folder; empty: the user's own
  std::string bind;  ///< where the pairing socket listens
};
/// 'macula-server clients list' and 'clients revoke NAME'.
struct ClientsCommand {
  std::string keys;
  std::string revoke;  ///< a client's name; empty: list them
};
using Command = std::variant<Options, PrintAndExit, PairCommand, ClientsCommand>;

/// Errors name the option or the file and line, and say what is allowed.
Result<Command> parse_options(int argc, const char* const* argv);

/// Ranges that hold whichever way a value came in.
Result<void> check_options(const Options& options);

/// One "name = value" line each, as the settings file would have them.
std::string describe(const Options& options);

}  // namespace macula::server_app
