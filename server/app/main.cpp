// macula-server: reads arguments and environment, runs, and turns errors into exit statuses.
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>

#include "server/app/app.h"
#include "server/app/launch.h"
#include "server/app/options.h"
#include "server/app/stop_signal.h"
#include "shared/net/keys.h"

namespace {

using namespace macula;

int report(const Error& error) {
  // Where several ranks fail together, one speaks.
  if (!error.message().empty()) std::cerr << "macula-server: " << error.message() << "\n";
  return error.exit_status();
}

/// PREFIX/share/macula/ladders of a program in PREFIX/bin; empty where nobody can tell.
std::string ladders_beside_program() {
  std::error_code unknown;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", unknown);
  if (unknown) return {};
  return (program.parent_path().parent_path() / "share" / "macula" / "ladders").string();
}

Result<void> run_command(const server_app::Command& command,
                         const server_app::Environment& environment, server_app::StopSignal& stop) {
  if (const auto* pair = std::get_if<server_app::PairCommand>(&command))
    return server_app::run_pair(*pair, environment, stop);
  if (const auto* clients = std::get_if<server_app::ClientsCommand>(&command))
    return server_app::run_clients(*clients, environment);
  return server_app::run(std::get<server_app::Options>(command), environment, stop);
}

int guarded_main(int argc, char** argv) {
  const auto parsed = server_app::parse_options(argc, argv);
  if (!parsed) return report(parsed.error());
  if (const auto* text = std::get_if<server_app::PrintAndExit>(&*parsed)) {
    std::cout << text->text;
    return EXIT_SUCCESS;
  }
  server_app::StopSignal stop;
  const server_app::Environment environment{
      net::default_key_folder(std::getenv("XDG_CONFIG_HOME"), std::getenv("HOME")),
      ladders_beside_program(), server_app::is_launched_by_mpi()};
  const auto done = run_command(*parsed, environment, stop);
  return done ? EXIT_SUCCESS : report(done.error());
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return guarded_main(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "macula-server: " << error.what() << "\n";
  } catch (...) {
    std::cerr << "macula-server: unknown failure\n";
  }
  return EXIT_FAILURE;
}
