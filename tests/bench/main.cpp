// macula-bench EXPERIMENT [options]: which experiment there is to run, and running it.
// Exit status: 0 done, 2 bad arguments or input, 1 anything else.
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include "tests/bench/commands.h"

namespace macula::bench {
namespace {

struct Experiment {
  const char* name;
  const char* summary;
  Run (*declare)(CLI::App& command, Pace pace);
};

constexpr Experiment kExperiments[] = {
    {"still", "One view of a scene for one eye, as a picture", declare_still},
    {"compare", "Every metric on two pictures", declare_compare},
    {"codecs", "Bytes, quality and cost of colour codecs on frames of a kernel", declare_codecs},
    {"contact-sheet", "A small picture of every scene, with its figures", declare_contact_sheet},
    {"culling", "Kernel culling against its baselines, error and time", declare_culling},
    {"light-tree", "What a tree over moving lights costs, and walks down it", declare_light_tree},
    {"lightcuts", "Methods of kernel lightcuts at equal time and equal error", declare_lightcuts},
    {"maps", "Bytes that foveation maps need for the same picture, to the eye", declare_maps},
    {"motion", "What a moment of a moving scene costs, part by part", declare_motion},
    {"sphere", "Foveated sphere tracing against plain, speed and quality", declare_sphere},
    {"report", "One HTML page of everything that experiments have left behind", declare_report},
    {"ray", "Foveated ray tracing against the full renderer, along a path", declare_ray},
    {"reprojection", "What each way of hiding latency is worth", declare_reprojection},
    {"scaling", "One frame by several ranks, measured, and modelled on a cluster", declare_scaling},
    {"streaming", "The stream over links that misbehave: ages, bytes, quality", declare_streaming},
    {"tradeoff", "Speed against accuracy: every kernel's knobs, with fronts", declare_tradeoff},
    {"warp", "What the client's warp costs", declare_warp},
};

int complain(const Error& error) {
  std::fprintf(stderr, "macula-bench: %s\n", error.message().c_str());
  return error.exit_status();
}

/// The first word must be an experiment or ask for help.
Result<void> check_experiment(int argc, const char* const* argv) {
  const std::string_view word = argc < 2 ? "" : argv[1];
  if (word == "-h" || word == "--help") return {};
  std::string names;
  for (const Experiment& entry : kExperiments) {
    if (entry.name == word) return {};
    names += (names.empty() ? "" : ", ") + std::string(entry.name);
  }
  const std::string what =
      word.empty() ? "which experiment?" : "unknown experiment '" + std::string(word) + "'";
  return base::bad_input(what, {}, "there are: " + names + "; macula-bench --help explains");
}

int run(int argc, const char* const* argv) {
  if (const auto known = check_experiment(argc, argv); !known) return complain(known.error());
  CLI::App app{"Pictures, measurements and comparisons of the Macula renderer.", "macula-bench"};
  app.require_subcommand(1);
  app.get_formatter()->label("SUBCOMMAND", "EXPERIMENT");
  app.footer("macula-bench EXPERIMENT --help explains one of them.");
  const bool quick = std::any_of(
      argv, argv + argc, [](const char* word) { return std::string_view(word) == "--quick"; });
  std::vector<std::pair<CLI::App*, Run>> commands;
  for (const Experiment& entry : kExperiments) {
    CLI::App* command = app.add_subcommand(entry.name, entry.summary);
    command->group("Experiments");
    commands.emplace_back(command, entry.declare(*command, quick ? Pace::Quick : Pace::Full));
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    return complain({error.what(), {}, "macula-bench --help lists what is allowed"});
  }
  for (const auto& [command, start] : commands) {
    if (!command->parsed()) continue;
    if (const auto done = start(); !done) return complain(done.error());
  }
  if (std::fflush(stdout) != 0)
    return complain({"standard output cannot be written", {}, {}, base::ErrorKind::Runtime});
  return 0;
}

}  // namespace
}  // namespace macula::bench

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);  // a closed pipe is an error to report, not a way to die
  try {
    return macula::bench::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "macula-bench: unexpected: %s\n", error.what());
  } catch (...) {
    std::fputs("macula-bench: unexpected failure\n", stderr);
  }
  return 1;
}
