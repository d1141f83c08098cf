// Under mpirun: every kernel in both modes by all ranks together, against rank 0 alone. Exit status
// 0 where all pictures are the same to the bit. With --swap, rank 1's results come in another
// order: the twin, which must fail.
#include <algorithm>
#include <iostream>
#include <span>
#include <string_view>

#include "server/cluster/mpi/mpi_ranks.h"
#include "tests/server/cluster/shared_frames.h"

namespace {

using namespace macula;

/// Swaps two parts of what other ranks send.
class Swapping final : public scheduling::RankGroup {
 public:
  explicit Swapping(std::shared_ptr<scheduling::RankGroup> ranks) : ranks_(std::move(ranks)) {}
  int rank() const override { return ranks_->rank(); }
  int size() const override { return ranks_->size(); }
  bool trade(scheduling::Mail& mail) override { return ranks_->trade(mail) && swap(mail); }
  bool broadcast(scheduling::Bytes& bytes) override { return ranks_->broadcast(bytes); }
  void begin_tickets() override { ranks_->begin_tickets(); }
  std::size_t take_ticket() override { return ranks_->take_ticket(); }
  void announce_stop(std::uint64_t pass) override { ranks_->announce_stop(pass); }
  bool hears_stop(std::uint64_t pass) override { return ranks_->hears_stop(pass); }
  std::string lost() const override { return ranks_->lost(); }

 private:
  bool swap(scheduling::Mail& mail) const {
    if (rank() != 0 || mail.from.size() < 2 || mail.from[1].size() < 8192) return true;
    const std::span<std::byte> message = mail.from[1];
    std::swap_ranges(message.begin() + 512, message.begin() + 2048,
                     message.begin() + static_cast<std::ptrdiff_t>(message.size() / 8 * 4));
    return true;
  }
  std::shared_ptr<scheduling::RankGroup> ranks_;
};

int run(bool swaps) {
  const auto made = cluster::MpiRanks::create(std::chrono::seconds{60});
  if (!made) {
    std::cerr << made.error().message() << "\n";
    return 2;
  }
  std::shared_ptr<scheduling::RankGroup> ranks = *made;
  if (swaps) ranks = std::make_shared<Swapping>(ranks);
  int different = 0;
  for (const test::Case& of : test::cases()) {
    const auto kernels = test::kernels_of(of);
    const auto timeline = test::timeline_of(of.scene);
    scheduling::TileScheduler scheduler(1);
    if (ranks->rank() != 0) {
      const auto done = cluster::follow(*ranks, {kernels, *timeline, scheduler});
      if (!done) return 1;
      if (swaps) break;
      continue;
    }
    const auto leader = std::make_shared<cluster::Leader>(ranks, scheduling::Balance::Predicted);
    const auto together =
        test::render(cluster::RankedKernel(kernels[0], 0, leader), *timeline, scheduler);
    leader->end();
    const bool same = test::same_bits(test::render_alone(of), together);
    std::cout << of << (same ? ": the same\n" : ": different\n");
    different += same ? 0 : 1;
    if (swaps) break;  // the payloads of the first are pixels alone
  }
  return different == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  return run(argc > 1 && std::string_view(argv[1]) == "--swap");
}
