// macula-client: options, a signal, one run, an exit status.
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iostream>

#include "client/app/doctor.h"
#include "client/app/options.h"
#include "client/app/pair_command.h"
#include "client/app/run_client.h"
#include "shared/base/clock.h"
#include "shared/base/log.h"

namespace {

using namespace macula;

std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set from a signal handler");

void on_signal(int) {
  interrupted = true;
}

int fail(const Error& error) {
  std::cerr << "macula-client: " << error.message() << "\n";
  return error.exit_status();
}

void print_config(const client_app::ClientConfig& config) {
  std::string line = "settings:";
  for (const auto& [key, value] : client_app::describe(config)) line += " " + key + "=" + value;
  base::log_info(line);
}

int examine(const client_app::ClientConfig& config) {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  return client_app::run_doctor(config, base::SteadyClock{}, interrupted, std::cout) ? 0 : 1;
}

int run(const client_app::Options& options) {
  if (options.task == client_app::Task::Examine) return examine(options.config);
  base::set_log_level(options.verbosity == client_app::Verbosity::Verbose ? base::LogLevel::Trace
                                                                          : base::LogLevel::Info);
  print_config(options.config);
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  const base::SteadyClock clock;
  const auto report = client_app::run_client(options.config, clock, interrupted);
  if (!report) return fail(report.error());
  std::cout << display::summary(*report);
  if (!options.config.out_folder.empty()) {
    std::cout << "pictures and report.json are in " << options.config.out_folder << "\n";
  }
  if (report->ended == display::RunEnd::HeadsetLost)
    return fail({"the OpenXR runtime went away", "headset",
                 "start it again; the report covers the time until then",
                 base::ErrorKind::Runtime});
  if (report->ended != display::RunEnd::ServerSilent) return 0;
  return fail({"the server sent no frame for too long", options.config.connect,
               "is it still running, and not too busy? the report covers the time until then",
               base::ErrorKind::Runtime});
}

int pair(const client_app::PairCommand& command) {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  const base::SteadyClock clock;
  const auto paired = client_app::run_pair(command, clock, interrupted);
  return paired ? 0 : fail(paired.error());
}

int run_main(int argc, const char* const* argv) {
  const client_app::Environment environment{std::getenv("XDG_CONFIG_HOME"), std::getenv("HOME"),
                                            std::getenv("DISPLAY"), std::getenv("WAYLAND_DISPLAY")};
  const auto parsed = client_app::parse_options(argc, argv, environment);
  if (!parsed) return fail(parsed.error());
  if (const auto* asked = std::get_if<client_app::TextAsked>(&*parsed)) {
    std::cout << asked->text;
    return 0;
  }
  if (const auto* command = std::get_if<client_app::PairCommand>(&*parsed)) return pair(*command);
  return run(std::get<client_app::Options>(*parsed));
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run_main(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "macula-client: %s\n", error.what());
  } catch (...) {
    std::fputs("macula-client: an unknown error\n", stderr);
  }
  return 1;
}
