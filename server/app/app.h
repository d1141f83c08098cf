// macula-server put together: options become a scene, a kernel, an endpoint and a server that runs
// until a signal stops it.
#pragma once

#include <string>

#include "server/app/options.h"
#include "server/app/stop_signal.h"
#include "shared/base/result.h"

namespace macula::server_app {

/// What the programs read from the environment, by main.
struct Environment {
  std::string default_key_folder;
  std::string installed_ladders;  ///< folder of quality ladders that came with the program
  bool launched_by_mpi = false;   ///< mpirun or Slurm started this process as one of several
};

/// Pairs one client, prints what a person must do, and ends: after success, after two minutes, or
/// when `stop` fires. An error when nobody was paired.
Result<void> run_pair(const PairCommand& command, const Environment& environment, StopSignal& stop);
Result<void> run_clients(const ClientsCommand& command, const Environment& environment);

/// Serves until `stop` fires, or prints what was asked for. Everything a user wants to know goes to
/// stdout, the log to stderr.
Result<void> run(Options options, const Environment& environment, StopSignal& stop);

}  // namespace macula::server_app
