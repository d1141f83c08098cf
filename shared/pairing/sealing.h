// Who somebody is, sealed under a run's session key: encrypted with XChaCha20, then authenticated
// with HMAC-SHA-512-256, each direction with keys of its own. HMAC rather than a one-time
// authenticator: a seal opens under no second key, so one message tests one guess only.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "shared/pairing/cpace.h"

namespace macula::pairing {

using PublicKey = std::array<unsigned char, 32>;  ///< of CURVE, as it is

struct Identity {
  static constexpr std::size_t kMostName = 64;
  PublicKey key{};
  std::string name;  ///< what the machine calls itself, at most kMostName bytes, of any kind
  friend bool operator==(const Identity&, const Identity&) = default;
};

enum class Direction { FromGuest, FromHost };

/// A longer name is cut.
std::string seal(const Identity& identity, const SessionKey& key, Direction direction);
/// nullopt unless it was sealed, whole, under this key in this direction.
std::optional<Identity> open_seal(std::string_view sealed, const SessionKey& key,
                                  Direction direction);

}  // namespace macula::pairing
