#include "server/app/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <sstream>

#include "server/app/command_line.h"
#include "server/app/settings_file.h"
#include "server/scheduling/balance.h"
#include "shared/base/text.h"
#include "shared/codec/h264.h"
#include "shared/foveation/rate.h"
#include "shared/net/pairing_socket.h"

namespace macula::server_app {
namespace {

struct Subcommands {
  CLI::App *pair, *clients, *revoke;
  std::string pair_bind = net::kPairingBind, revoked;
};

/// Options of the program itself, such as --keys, may follow a subcommand too.
void declare_subcommands(CLI::App& app, Subcommands& commands) {
  app.fallthrough();
  app.require_subcommand(0, 1);
  commands.pair = app.add_subcommand(
      "pair", "Let a client of another machine in: shows a code for 'macula-client pair'");
  commands.pair->add_option("--bind", commands.pair_bind, "Where to listen while pairing")
      ->option_text(base::concat("ENDPOINT (", net::kPairingBind, ")"));
  commands.clients = app.add_subcommand("clients", "Who may connect");
  for (CLI::App* command : {commands.pair, commands.clients})
    command->footer("--keys DIR before or after names another key folder.\n");
  commands.clients->require_subcommand(1);
  commands.clients->add_subcommand("list", "List their names and keys");
  commands.revoke = commands.clients->add_subcommand(
      "revoke", "Take a client's permission back; its session ends within a second");
  commands.revoke->add_option("NAME", commands.revoked, "As the list has it")->required();
}

Result<Command> parse_over(Options options, int argc, const char* const* argv) {
  CLI::App app{"Render server of Macula: streams foveated frames to headset clients",
               "macula-server"};
  Subcommands commands;
  declare_options(app, options);
  declare_subcommands(app, commands);
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    return PrintAndExit{app.help()};
  } catch (const CLI::CallForVersion&) {
    return PrintAndExit{app.version() + "\n"};
  } catch (const CLI::ParseError& error) {
    return base::bad_input(error.what(), {}, "--help lists the options");
  }
  if (commands.pair->parsed()) return PairCommand{options.keys, commands.pair_bind};
  if (commands.clients->parsed()) return ClientsCommand{options.keys, commands.revoked};
  return options;
}

Result<void> in_range(std::string_view option, double value, double low, double high) {
  if (value >= low && value <= high) return {};
  return base::bad_input(base::concat("is ", value), std::string(option),
                         base::concat(low, " to ", high));
}

}  // namespace

Result<Command> parse_options(int argc, const char* const* argv) {
  auto parsed = parse_over({}, argc, argv);
  if (!parsed) return parsed;
  const Options* direct = std::get_if<Options>(&*parsed);
  if (direct != nullptr && !direct->config.empty()) {
    Options from_file;
    if (const auto applied = apply_settings_file(direct->config, from_file); !applied)
      return base::forward(applied);
    parsed = parse_over(std::move(from_file), argc, argv);
    if (!parsed) return parsed;
  }
  if (const Options* options = std::get_if<Options>(&*parsed))
    if (const auto good = check_options(*options); !good) return base::forward(good);
  return parsed;
}

Result<void> check_options(const Options& o) {
  if (o.target_ms)
    if (auto ok = in_range("--target-ms", *o.target_ms, 0.1, 10'000.0); !ok) return ok;
  if (o.quality && !(*o.quality >= 0.0 && *o.quality <= 10.0))
    return base::bad_input(base::concat("is ", *o.quality), "--quality",
                           "0 to 10; --color-quality is that of colour");
  if (o.max_error)
    if (auto ok = in_range("--max-error", *o.max_error, 1e-6, 1.0); !ok) return ok;
  if (auto ok = in_range("--color-quality", o.color_quality, 1, 100); !ok) return ok;
  if (auto ok = in_range("--area-samples", o.area_samples, 1, 1024); !ok) return ok;
  if (auto ok = in_range("--ambient-samples", o.ambient_samples, 0, 1024); !ok) return ok;
  if (!o.knobs.empty() && (o.quality || o.max_error))
    return base::bad_input("turns knobs that the quality ladder turns, too", "--knobs",
                           "one of --knobs, or --quality and --max-error");
  if (auto ok = in_range("--threads", o.threads, 0, 1024); !ok) return ok;
  if (auto ok = in_range("--rank-timeout-ms", o.rank_timeout_ms, 100, 600'000); !ok) return ok;
  if (std::ranges::find(scheduling::kBalanceNames, o.balance) ==
      std::end(scheduling::kBalanceNames))
    return base::bad_input("no balance is called '" + o.balance + "'", "--balance",
                           "predicted, stripes or dynamic");
  if (!(o.guard_deg >= 0.0 && o.guard_deg <= 15.0))
    return base::bad_input(base::concat("is ", o.guard_deg), "--guard-deg", "0 to 15");
  if (auto ok = in_range("--predict-ms", o.predict_ms, 0.0, 200.0); !ok) return ok;
  if (auto ok = in_range("--view-cell-cm", o.view_cell_cm, 0.0, 20.0); !ok) return ok;
  if (o.age_ms != 0.0)
    if (auto ok = in_range("--age-ms", o.age_ms, 20.0, 10'000.0); !ok) return ok;
  if (o.codec != "auto" && o.codec != "jpeg" && o.codec != "h264" && o.codec != "lossless")
    return base::bad_input(base::concat("unknown codec '", o.codec, "'"), "--codec",
                           "auto, jpeg, h264, lossless");
  if (o.codec == "h264" && !codec::can_encode_h264())
    return base::bad_input("this build cannot encode h264", "--codec",
                           "auto, jpeg, lossless; or build with -DMACULA_H264=ON");
  if (o.oversampling != 1.5 && !(o.oversampling >= 1.0 && o.oversampling <= 4.0 &&
                                 o.oversampling == std::floor(o.oversampling)))
    return base::bad_input(base::concat("is ", o.oversampling), "--oversampling",
                           "1, 1.5, 2, 3 or 4");
  if (const auto model = foveation::find_rate_model(o.rate_model); !model)
    return base::forward(model);
  return {};
}

std::string describe(const Options& o) {
  std::ostringstream text;
  const auto quoted = [](const std::string& value) { return '"' + value + '"'; };
  text << "scene = " << quoted(o.scene) << "\nkernel = " << quoted(o.kernel)
       << "\nbind = " << quoted(o.bind) << "\nkeys = " << quoted(o.keys) << '\n';
  if (o.target_ms) text << "target_ms = " << *o.target_ms << '\n';
  if (o.quality) text << "quality = " << *o.quality << '\n';
  if (o.max_error) text << "max_error = " << *o.max_error << '\n';
  text << "rate_model = " << quoted(o.rate_model) << "\noversampling = " << o.oversampling
       << "\nguard_deg = " << o.guard_deg << "\npredict_ms = " << o.predict_ms
       << "\nview_cell_cm = " << o.view_cell_cm << "\nage_ms = " << o.age_ms
       << "\ncolor_quality = " << o.color_quality << "\ncodec = " << quoted(o.codec)
       << "\narea_samples = " << o.area_samples << "\nambient_samples = " << o.ambient_samples
       << "\nknobs = " << quoted(o.knobs) << "\nthreads = " << o.threads
       << "\nbalance = " << quoted(o.balance) << "\nrank_timeout_ms = " << o.rank_timeout_ms
       << "\nreuse = " << (o.reuse ? "true" : "false")
       << "\nperceived_lights = " << (o.perceived_lights ? "true" : "false")
       << "\nbounced_rays = " << o.bounced_rays << "\nmetrics = " << quoted(o.metrics)
       << "\nverbose = " << (o.verbose ? "true" : "false") << '\n';
  return std::move(text).str();
}

}  // namespace macula::server_app
