// RankGroup: the processes ("ranks", 0 .. size() - 1) that make one frame together, as the
// TileScheduler sees them. All ranks call the same functions in the same order, one thread of each
// at a time (take_ticket: any). A rank that dies or is silent for longer than the group waits is
// lost for good: from then on every call returns false at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "server/scheduling/bytes.h"

namespace macula::scheduling {

/// What every rank gave, one after the other.
class Gathered {
 public:
  Gathered() = default;
  /// Room for as many bytes of each rank as `sizes` says.
  explicit Gathered(std::span<const std::size_t> sizes) {
    for (const std::size_t size : sizes) ends_.push_back(end() + size);
    bytes_ = std::make_unique_for_overwrite<std::byte[]>(end());
  }
  std::size_t ranks() const { return ends_.size(); }
  std::span<std::byte> of(std::size_t rank) {
    const std::size_t begin = rank == 0 ? 0 : ends_[rank - 1];
    return {bytes_.get() + begin, ends_[rank] - begin};
  }

 private:
  std::size_t end() const { return ends_.empty() ? 0 : ends_.back(); }
  std::vector<std::size_t> ends_;
  std::unique_ptr<std::byte[]> bytes_;
};

class RankGroup {
 public:
  virtual ~RankGroup() = default;
  virtual int rank() const = 0;
  virtual int size() const = 0;

  /// Every rank gets what all ranks gave, into room made for it; where there is none, ranks tell
  /// each other sizes first. False: a rank was lost.
  [[nodiscard]] virtual bool all_gather(const Bytes& mine, Gathered& all) = 0;
  /// Rank 0 alone gets it, into room made for it; the others' `all` is not touched.
  [[nodiscard]] virtual bool gather(const Bytes& mine, Gathered& all) = 0;
  /// Rank r gets `to[r]` of every rank, its own too.
  [[nodiscard]] virtual bool trade(const std::vector<Bytes>& to, Gathered& from) = 0;
  /// What rank 0 holds replaces what the others do. They wait for it however long it takes.
  [[nodiscard]] virtual bool broadcast(Bytes& bytes) = 0;
  /// Tickets 0, 1, 2, ... over all ranks together, anew from here on.
  virtual void begin_tickets() = 0;
  virtual std::size_t take_ticket() = 0;
  /// Rank 0 leaves pass number `pass` before its end; others may, too, once they hear of it.
  /// Threads of a rank may ask at the same time.
  virtual void announce_stop(std::uint64_t pass) = 0;
  virtual bool hears_stop(std::uint64_t pass) = 0;
  /// Passes count from 1, on all ranks alike.
  std::uint64_t begin_pass() { return ++passes_; }
  /// Who was lost, in words for people; empty while nobody is.
  virtual std::string lost() const = 0;

 private:
  std::uint64_t passes_ = 0;
};

}  // namespace macula::scheduling
