// What a Hello or a change of settings must satisfy before it becomes a session's setup. Pure
// checks; each refusal says what this server offers.
#pragma once

#include <string>

#include "server/session/actions.h"
#include "shared/base/result.h"

namespace macula::session {

/// The best codec that both ends know: h264, then jpeg, then lossless.
inline constexpr const char* kAutoCodec = "auto";

/// What this server is and offers; the same for every client.
struct ServerOffer {
  std::string kernel = "ray";
  std::string default_codec = kAutoCodec;
  net::SceneSummary scene;
  std::uint32_t max_part_bytes = 65536;
  int max_side_px = 8192;
};

/// Codec, quality, rate model and oversampling: known and in range; 0 and "" mean the default.
Result<void> check_settings(const net::Settings& settings);
/// 1 or 2 eyes with valid displays, a refresh rate in (0, 1000] Hz, a codec in common, good
/// settings.
Result<ClientSetup> check_hello(const net::Hello& hello, const ServerOffer& offer);
/// "jpeg" or "lossless": the client's wish where it has one, else the offer's default, else
/// whichever of the two the client can decode.
std::string negotiated_codec(const net::Hello& hello, const ServerOffer& offer);

}  // namespace macula::session
