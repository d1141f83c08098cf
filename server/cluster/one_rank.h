// OneRank: a group of this process alone, for what wants to see a frame's passes without others.
#pragma once

#include <atomic>

#include "server/scheduling/rank_group.h"

namespace macula::cluster {

class OneRank final : public scheduling::RankGroup {
 public:
  int rank() const override { return 0; }
  int size() const override { return 1; }
  bool trade(scheduling::Mail&) override { return true; }
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
