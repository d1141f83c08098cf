// ThreadRanks: a group of ranks that are threads of this process, so that what they do together can
// be tested without MPI and under sanitizers. A message may be tampered with on its way.
#pragma once

#include <algorithm>
#include <atomic>
#include <barrier>
#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "server/scheduling/rank_group.h"

namespace macula::test {

/// Called for what rank 0 gets from another rank in gathers number `call` (from 0).
using Tamper = std::function<void(int rank, int call, std::span<std::byte> message)>;

/// What the threads share.
struct Meeting {
  explicit Meeting(int ranks)
      : size(ranks), barrier(ranks), given(static_cast<std::size_t>(ranks)), traded(given.size()) {}
  int size;
  std::barrier<> barrier;
  std::vector<const scheduling::Bytes*> given;
  std::vector<const std::vector<scheduling::Bytes>*> traded;
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
  bool all_gather(const scheduling::Bytes& mine, scheduling::Gathered& all) override {
    meet(mine, &all);
    return true;
  }
  bool gather(const scheduling::Bytes& mine, scheduling::Gathered& all) override {
    meet(mine, rank_ == 0 ? &all : nullptr);
    return true;
  }
  bool trade(const std::vector<scheduling::Bytes>& to, scheduling::Gathered& from) override {
    const auto own = static_cast<std::size_t>(rank_);
    meeting_->traded[own] = &to;
    meeting_->barrier.arrive_and_wait();
    std::vector<std::size_t> sizes;
    for (const auto* parts : meeting_->traded) sizes.push_back((*parts)[own].size());
    from = scheduling::Gathered(sizes);
    for (std::size_t other = 0; other < sizes.size(); ++other) {
      std::ranges::copy((*meeting_->traded[other])[own], from.of(other).begin());
      if (rank_ == 0 && other != 0 && meeting_->tamper)
        meeting_->tamper(static_cast<int>(other), calls_, from.of(other));
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
  void meet(const scheduling::Bytes& mine, scheduling::Gathered* all) {
    give(mine);
    if (all != nullptr) {
      std::vector<std::size_t> sizes;
      for (const scheduling::Bytes* bytes : meeting_->given) sizes.push_back(bytes->size());
      *all = scheduling::Gathered(sizes);
      for (std::size_t other = 0; other < sizes.size(); ++other) {
        if (sizes[other] == 0) continue;
        std::memcpy(all->of(other).data(), meeting_->given[other]->data(), sizes[other]);
        if (rank_ == 0 && other != 0 && meeting_->tamper)
          meeting_->tamper(static_cast<int>(other), calls_, all->of(other));
      }
    }
    ++calls_;
    meeting_->barrier.arrive_and_wait();
  }

  std::shared_ptr<Meeting> meeting_;
  int rank_, calls_ = 0;
};

}  // namespace macula::test
