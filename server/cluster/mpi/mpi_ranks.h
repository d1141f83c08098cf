// MpiRanks: the ranks of a program that mpirun or Slurm started, as a RankGroup. The only place
// that knows MPI. A build without MPI has create() as an error. Waiting sleeps between looks, so
// that idle ranks leave the processor to others.
#pragma once

#include <chrono>
#include <memory>

#include "server/scheduling/rank_group.h"
#include "shared/base/result.h"

namespace macula::cluster {

class MpiRanks final : public scheduling::RankGroup {
 public:
  /// Once a process, by all ranks. `patience`: how long rank 0 waits for a rank that should have
  /// come to the same point; the others wait three times as long for rank 0. Errors: MPI cannot
  /// begin, or there is none in this build.
  static Result<std::shared_ptr<MpiRanks>> create(std::chrono::milliseconds patience);
  /// Says farewell to the others; where a rank was lost, ends all of them with status 1.
  ~MpiRanks() override;

  int rank() const override;
  int size() const override;
  bool trade(scheduling::Mail& mail) override;
  bool broadcast(scheduling::Bytes& bytes) override;
  void begin_tickets() override;
  std::size_t take_ticket() override;
  void announce_stop(std::uint64_t pass) override;
  bool hears_stop(std::uint64_t pass) override;
  std::string lost() const override;

  /// The first `ranks` of these alone; for the others, nullptr. Called by all.
  std::shared_ptr<scheduling::RankGroup> first(int ranks);

 private:
  struct Group;
  explicit MpiRanks(std::unique_ptr<Group> group);
  std::unique_ptr<Group> group_;
  bool owns_mpi_ = true;
};

}  // namespace macula::cluster
