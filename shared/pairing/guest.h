// The client's side of pairing as a pure state machine: one code, one run. Whoever answers without
// knowing the code has tested one guess, and pairing has failed. Not thread-safe.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "shared/pairing/code.h"
#include "shared/pairing/messages.h"
#include "shared/pairing/sealing.h"

namespace macula::pairing {

/// Send this.
struct Say {
  std::string bytes;
};
/// Both sides knew the code: this is the host.
struct Paired {
  Identity host;
};
struct Failed {
  std::string text;  ///< what it means and what to do
};
/// Not for us, damaged, or repeated.
struct Ignored {};
using GuestStep = std::variant<Ignored, Say, Paired, Failed>;

class Guest {
 public:
  Guest(Code code, Identity own, Random random);

  /// The first message; the host begins a new run for every one it hears.
  std::string greeting() const;
  GuestStep handle(std::string_view bytes);

 private:
  GuestStep on(const Offer& offer);
  GuestStep on(const Grant& grant);
  GuestStep on(const Denial& denial);
  template <class Other>
  GuestStep on(const Other&) {
    return Ignored{};
  }

  Code code_;
  Identity own_;
  Random random_;
  Nonce nonce_;
  std::optional<SessionKey> key_;  ///< once an Offer was answered
};

}  // namespace macula::pairing
