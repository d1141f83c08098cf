// Whether this process is one of several, told before MPI is touched.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <iterator>

namespace macula::server_app {

/// By the environment: Open MPI's mpirun, other launchers by PMI, Slurm by PMIx.
inline bool is_launched_by_mpi() {
  constexpr const char* kSigns[] = {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK"};
  return std::any_of(std::begin(kSigns), std::end(kSigns),
                     [](const char* name) { return std::getenv(name) != nullptr; });
}

}  // namespace macula::server_app
