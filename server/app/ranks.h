// Several processes as one server: joining, agreeing on what is served, following rank 0. A
// process that was started alone is not concerned.
#pragma once

#include <memory>
#include <string>

#include "server/app/app.h"
#include "server/app/options.h"
#include "server/cluster/mpi/mpi_ranks.h"
#include "server/cluster/ranked_kernel.h"

namespace macula::server_app {

using Ranks = std::shared_ptr<cluster::MpiRanks>;
using KernelList = std::vector<std::shared_ptr<const kernels::Kernel>>;

/// nullptr: this process was started alone. Errors: a build without MPI.
Result<Ranks> join_ranks(const Options& options, const Environment& environment);

/// All ranks go on, or none does: where one has an error, or another scene or other settings than
/// rank 0 (`what`: all that must be the same), all return an error, that of the followers without
/// words.
Result<void> agree(cluster::MpiRanks& ranks, const Result<void>& mine, const std::string& what);

/// The kernels as rank 0 uses them.
KernelList shared_by_ranks(const KernelList& kernels,
                           const std::shared_ptr<cluster::Leader>& leader);

scheduling::Balance balance_of(const Options& options);

}  // namespace macula::server_app
