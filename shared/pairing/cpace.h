// CPace, a balanced password-authenticated key exchange, in the suite CPACE-RISTR255-SHA512 with
// initiator and responder (draft-irtf-cfrg-cpace-13, sections 6, 7.3 and 8). Whoever takes part in
// a run without the password, as a man in the middle too, can test one guess in it and no more;
// whoever only listens can test none. Group and hash are libsodium's. Pure.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace macula::pairing {

using Share = std::array<unsigned char, 32>;   ///< an encoded ristretto255 element
using Scalar = std::array<unsigned char, 32>;  ///< little-endian, below the group's order
using SessionKey = std::array<unsigned char, 64>;

/// What both sides must agree on before a run.
struct CpaceInputs {
  std::string_view password;
  std::string_view channel;  ///< CI: who and what the run is for
  std::string_view session;  ///< sid: fresh for every run
};

/// Section 7.3: the generator all shares of these inputs are multiples of.
Share cpace_generator(const CpaceInputs& inputs);

/// A scalar from 32 uniform bytes: the bits above 252 are cleared (section 7.3).
Scalar cpace_scalar(std::span<const unsigned char, 32> uniform);

/// The share `scalar` times `generator`.
Share cpace_share(const Share& generator, const Scalar& scalar);

struct CpaceTranscript {
  Share initiator, responder;
  std::string_view initiator_data, responder_data;  ///< ADa, ADb
};
/// ISK of section 6.2; nullopt when the peer's share is no element or the neutral one.
std::optional<SessionKey> cpace_key(std::string_view session, const Scalar& own, const Share& peer,
                                    const CpaceTranscript& transcript);

}  // namespace macula::pairing
