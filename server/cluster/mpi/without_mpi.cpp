#include "server/cluster/mpi/mpi_ranks.h"

namespace macula::cluster {

struct MpiRanks::Group {};

Result<std::shared_ptr<MpiRanks>> MpiRanks::create(std::chrono::milliseconds) {
  return base::bad_input("this program was built without MPI and runs as one process only",
                         "cluster",
                         "start it without mpirun, or build it with libopenmpi-dev installed and "
                         "MACULA_MPI=ON");
}

// Nobody has one: create() is the only way to come by it.
MpiRanks::MpiRanks(std::unique_ptr<Group> group) : group_(std::move(group)) {}
MpiRanks::~MpiRanks() = default;
int MpiRanks::rank() const {
  return 0;
}
int MpiRanks::size() const {
  return 1;
}
std::string MpiRanks::lost() const {
  return {};
}
bool MpiRanks::trade(scheduling::Mail&) {
  return false;
}
bool MpiRanks::broadcast(scheduling::Bytes&) {
  return false;
}
void MpiRanks::begin_tickets() {}
std::size_t MpiRanks::take_ticket() {
  return 0;
}
void MpiRanks::announce_stop(std::uint64_t) {}
bool MpiRanks::hears_stop(std::uint64_t) {
  return false;
}
std::shared_ptr<scheduling::RankGroup> MpiRanks::first(int) {
  return nullptr;
}

}  // namespace macula::cluster
