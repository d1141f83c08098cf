// ThreadRanks: a group of ranks that are threads of this process, so that what they do together can
// be tested without MPI and under sanitizers. A message may be tampered with on its way.
#pragma once

#include <algorithm>
#include <atomic>
#include <barrier>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "server/scheduling/rank_group.h"
#include "shared/base/check.h"

namespace macula::test {

/// Called for what rank 0 gets from another rank in trades number `call` (from 0).
using Tamper = std::function<void(int rank, int call, std::span<std::byte> message)>;

/// What the threads share.
struct Meeting {
  explicit Meeting(int ranks)
      : size(ranks), barrier(ranks), given(static_cast<std::size_t>(ranks)), mail(given.size()) {}
  int size;
  std::barrier<> barrier;
  std::vector<const scheduling::Bytes*> given;
  std::vector<const scheduling::Mail*> mail;
  std::atomic<std::size_t> tickets{0};
  std::atomic<std::uint64_t> stopped{0};  ///< pass
  Tamper tamper;
};

class ThreadRanks final : public scheduling::RankGroup {
 public:
  ThreadRanks(std::shared_ptr<Meeting> meeting, int rank)
      : meeting_(std::move(meeting)), rank_(rank) {}

  int rank() const override { return rank_; }
  int size() const override { return meeting_->size; }
  bool trade(scheduling::Mail& mail) override {
    const auto own = static_cast<std::size_t>(rank_);
    meeting_->mail[own] = &mail;
    meeting_->barrier.arrive_and_wait();
    for (std::size_t other = 0; other < mail.from.size(); ++other) {
      if (other == own) continue;
      const auto& given = meeting_->mail[other]->to[own];
      MACULA_CHECK(given.has_value() == mail.comes[other], "both sides know of a message");
      if (!given) continue;
      mail.from[other].assign(given->begin(), given->end());
      if (rank_ == 0 && meeting_->tamper)
        meeting_->tamper(static_cast<int>(other), calls_, mail.from[other]);
    }
    ++calls_;
    meeting_->barrier.arrive_and_wait();
    return true;
  }
  bool broadcast(scheduling::Bytes& bytes) override {
    give(bytes);
    if (rank_ != 0) bytes = *meeting_->given[0];
    meeting_->barrier.arrive_and_wait();
    return true;
  }
  void begin_tickets() override {
    meeting_->barrier.arrive_and_wait();
    if (rank_ == 0) meeting_->tickets = 0;
    meeting_->barrier.arrive_and_wait();
  }
  std::size_t take_ticket() override { return meeting_->tickets++; }
  void announce_stop(std::uint64_t pass) override { meeting_->stopped = pass; }
  bool hears_stop(std::uint64_t pass) override { return meeting_->stopped == pass; }
  std::string lost() const override { return {}; }

 private:
  void give(const scheduling::Bytes& mine) {
    meeting_->given[static_cast<std::size_t>(rank_)] = &mine;
    meeting_->barrier.arrive_and_wait();
  }

  std::shared_ptr<Meeting> meeting_;
  int rank_, calls_ = 0;
};

}  // namespace macula::test
