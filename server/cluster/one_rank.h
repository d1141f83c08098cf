// OneRank: a group of this process alone, for what wants to see a frame's passes without others.
#pragma once

#include <algorithm>
#include <atomic>

#include "server/scheduling/rank_group.h"

namespace macula::cluster {

class OneRank final : public scheduling::RankGroup {
 public:
  int rank() const override { return 0; }
  int size() const override { return 1; }
  bool all_gather(const scheduling::Bytes& mine, scheduling::Gathered& all) override {
    const std::size_t size = mine.size();
    all = scheduling::Gathered({&size, 1});
    return gather(mine, all);
  }
  bool gather(const scheduling::Bytes& mine, scheduling::Gathered& all) override {
    std::ranges::copy(mine, all.of(0).begin());
    return true;
  }
  bool trade(const std::vector<scheduling::Bytes>& to, scheduling::Gathered& from) override {
    return all_gather(to.front(), from);
  }
  bool broadcast(scheduling::Bytes&) override { return true; }
  void begin_tickets() override { tickets_ = 0; }
  std::size_t take_ticket() override { return tickets_++; }
  void announce_stop(std::uint64_t) override {}
  bool hears_stop(std::uint64_t) override { return false; }
  std::string lost() const override { return {}; }

 private:
  std::atomic<std::size_t> tickets_{0};
};

}  // namespace macula::cluster
