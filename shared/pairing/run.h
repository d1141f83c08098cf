// What guest and host of one run compute alike. Internal.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "shared/pairing/cpace.h"
#include "shared/pairing/messages.h"
#include "shared/pairing/random.h"

namespace macula::pairing {

inline constexpr std::string_view kChannel = "macula pairing 1";
inline constexpr std::string_view kGuestData = "guest", kHostData = "host";

/// sid: both nonces, so neither side alone can repeat a run.
inline std::string session_of(const Nonce& guest, const Nonce& host) {
  std::string session(reinterpret_cast<const char*>(guest.data()), guest.size());
  return session.append(reinterpret_cast<const char*>(host.data()), host.size());
}

inline Nonce draw_nonce(const Random& random) {
  Nonce nonce{};
  random(nonce);
  return nonce;
}

inline Scalar draw_scalar(const Random& random) {
  Scalar uniform{};
  random(uniform);
  return cpace_scalar(uniform);
}

inline std::optional<SessionKey> key_of(std::string_view session, const Scalar& own,
                                        const Share& peer, const Share& guest, const Share& host) {
  return cpace_key(session, own, peer, {guest, host, kGuestData, kHostData});
}

}  // namespace macula::pairing
