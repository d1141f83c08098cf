// The server's side of pairing as a pure state machine: bytes and time in, bytes out. It is open
// for a short window and for one guest. A wrong code costs a try; after three the code is burnt,
// nobody may try for a minute, and then there is another code. So a window of two minutes grants a
// stranger at most six guesses at a million codes. Not thread-safe; bounded memory.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "shared/pairing/code.h"
#include "shared/pairing/messages.h"
#include "shared/pairing/sealing.h"
#include "shared/units/time.h"

namespace macula::pairing {

struct HostRules {
  Nanoseconds window{std::chrono::seconds{120}};
  int tries = 3;
  Nanoseconds lockout{std::chrono::seconds{60}};
  /// An Offer waits this long for its Proof.
  Nanoseconds run_lasts{std::chrono::seconds{10}};
  /// Runs at once; a further one takes the place of the oldest.
  std::size_t most_runs = 16;
};

struct HostCounters {
  std::uint64_t greetings = 0, wrong_codes = 0, malformed = 0, denied = 0;
};

class Host {
 public:
  Host(const HostRules& rules, Identity own, Random random, Nanoseconds now);

  /// Whoever sent a message, by connection.
  using Peer = std::string;
  struct Answer {
    std::string bytes;               ///< to the peer; empty: nothing
    std::optional<Identity> paired;  ///< this guest has proved the code; the window is closed
  };
  Answer handle(const Peer& peer, std::string_view bytes, Nanoseconds now);

  bool is_open(Nanoseconds now) const { return !paired_ && now < closes_; }
  /// What to show; nullopt while locked out or closed.
  std::optional<Code> code(Nanoseconds now) const;
  /// Until the window closes.
  Nanoseconds left(Nanoseconds now) const;
  const HostCounters& counters() const { return counters_; }

 private:
  struct Run {
    std::string session;
    Scalar scalar{};
    Share share{};
    Nanoseconds begun{0};
  };
  Answer on(const Peer& peer, const Greeting& greeting, Nanoseconds now);
  Answer on(const Peer& peer, const Proof& proof, Nanoseconds now);
  /// Messages that only hosts send.
  template <class Other>
  Answer on(const Peer&, const Other&, Nanoseconds) {
    ++counters_.malformed;
    return {};
  }
  std::optional<Identity> verify(const Run& run, const Proof& proof, std::string& grant) const;
  Answer on_wrong_code(Nanoseconds now);
  Answer deny(DenialReason reason, Nanoseconds wait);
  bool is_locked(Nanoseconds now) const { return now < locked_until_; }
  void make_room(Nanoseconds now);

  HostRules rules_;
  Identity own_;
  Random random_;
  Code code_;
  Nanoseconds closes_, locked_until_;
  int wrong_ = 0;
  bool paired_ = false;
  std::map<Peer, Run> runs_;
  HostCounters counters_;
};

}  // namespace macula::pairing
