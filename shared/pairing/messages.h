// What travels on the pairing socket, in bytes: "MACP", a version, a kind, then fields of fixed
// size, the last one excepted. No message is longer than kMostBytes. Who is who is told under the
// session key only.
//
//   guest (client)                                   host (server)
//   Greeting{nonce}                            ->
//                                              <-    Offer{nonce, share}
//   Proof{share, sealed identity of the guest} ->
//                                              <-    Grant{sealed identity of the host}
//                                              <-    Denial{reason, wait}   instead of either
//
// The guest proves the code first: a guess costs whoever makes it a try before anything sealed by
// the host comes back.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "shared/pairing/cpace.h"

namespace macula::pairing {

inline constexpr std::uint8_t kVersion = 1;
inline constexpr std::size_t kMostBytes = 1024;

using Nonce = std::array<unsigned char, 16>;

struct Greeting {
  Nonce nonce{};
};
struct Offer {
  Nonce nonce{};
  Share share{};
};
struct Proof {
  Share share{};
  std::string sealed;
};
struct Grant {
  std::string sealed;
};
enum class DenialReason : std::uint8_t {
  WrongVersion = 1,
  WrongCode,
  LockedOut,  ///< too many wrong codes
  NoRun,      ///< a Proof without an Offer, or too late
  Closed,     ///< nobody is being paired any more
};
struct Denial {
  DenialReason reason = DenialReason::Closed;
  std::uint16_t wait_s = 0;  ///< until trying again makes sense
};
using Message = std::variant<Greeting, Offer, Proof, Grant, Denial>;

std::string encode(const Message& message);
/// nullopt for anything that is not exactly one message of this version.
std::optional<Message> decode(std::string_view bytes);
/// The version of a message with our magic, whatever follows.
std::optional<std::uint8_t> version_of(std::string_view bytes);

}  // namespace macula::pairing
