// RankGroup: the processes ("ranks", 0 .. size() - 1) that make one frame together, as the
// TileScheduler sees them. All ranks call the same functions in the same order, one thread of each
// at a time (take_ticket: any). A rank that dies or is silent for longer than the group waits is
// lost for good: from then on every call returns false at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/scheduling/bytes.h"

namespace macula::scheduling {

/// The messages of one meeting, as one rank sees them; by rank, its own entries idle.
struct Mail {
  std::vector<std::optional<std::span<const std::byte>>> to;  ///< none: no message, not even empty
  std::vector<bool> comes;                                    ///< whether that rank sends one
  std::vector<Bytes> from;                                    ///< what it was
  std::vector<Bytes> written;                                 ///< memory for what `to` shows
};

class RankGroup {
 public:
  virtual ~RankGroup() = default;
  virtual int rank() const = 0;
  virtual int size() const = 0;

  /// For the next meeting, with no message in it, in the memory of the last.
  Mail& new_mail();
  /// Every rank gets what others have for it; both sides know between whom there is a message, and
  /// the receiver not how long it is. `mail` is a new one, filled in. False: a rank was lost.
  [[nodiscard]] virtual bool trade(Mail& mail) = 0;
  /// Every rank gets what all ranks gave. False: a rank was lost.
  [[nodiscard]] bool all_gather(const Bytes& mine, std::vector<Bytes>& all);
  /// What rank 0 holds replaces what the others do. They wait for it however long it takes.
  [[nodiscard]] virtual bool broadcast(Bytes& bytes) = 0;
  /// Tickets 0, 1, 2, ... over all ranks together, anew from here on; since the last series all
  /// ranks have had a message from each.
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
  Mail mail_;
};

}  // namespace macula::scheduling
