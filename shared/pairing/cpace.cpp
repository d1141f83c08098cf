#include "shared/pairing/cpace.h"

#include <sodium.h>

#include <algorithm>

#include "shared/base/check.h"

namespace macula::pairing {
namespace {

constexpr std::string_view kDomain = "CPaceRistretto255", kKeyDomain = "CPaceRistretto255_ISK";
constexpr std::size_t kHashBlock = 128;  ///< of SHA-512, bytes

std::string_view text(std::span<const unsigned char> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// prepend_len of appendix A: the length as LEB128, then the bytes.
std::string with_length(std::string_view bytes) {
  std::string out;
  std::size_t rest = bytes.size();
  do {
    const auto low = static_cast<unsigned char>(rest & 0x7FU);
    rest >>= 7U;
    out.push_back(static_cast<char>(rest == 0 ? low : low | 0x80U));
  } while (rest != 0);
  return out.append(bytes);
}

SessionKey sha512(std::string_view bytes) {
  SessionKey hash{};
  crypto_hash_sha512(hash.data(), reinterpret_cast<const unsigned char*>(bytes.data()),
                     bytes.size());
  return hash;
}

}  // namespace

Share cpace_generator(const CpaceInputs& inputs) {
  const std::string head = with_length(kDomain) + with_length(inputs.password);
  // The password fills the hash's first block, so that its length shows in no timing.
  const std::size_t padding = kHashBlock - 1 - std::min(head.size(), kHashBlock - 1);
  const SessionKey hash = sha512(head + with_length(std::string(padding, '\0')) +
                                 with_length(inputs.channel) + with_length(inputs.session));
  Share generator{};
  crypto_core_ristretto255_from_hash(generator.data(), hash.data());
  return generator;
}

Scalar cpace_scalar(std::span<const unsigned char, 32> uniform) {
  Scalar scalar{};
  std::copy(uniform.begin(), uniform.end(), scalar.begin());
  scalar.back() &= 0x0FU;
  return scalar;
}

Share cpace_share(const Share& generator, const Scalar& scalar) {
  Share share{};
  MACULA_CHECK(crypto_scalarmult_ristretto255(share.data(), scalar.data(), generator.data()) == 0,
               "a scalar of zero");
  return share;
}

std::optional<SessionKey> cpace_key(std::string_view session, const Scalar& own, const Share& peer,
                                    const CpaceTranscript& transcript) {
  Share secret{};
  // Refuses what is not an element's encoding, and a neutral result.
  if (crypto_scalarmult_ristretto255(secret.data(), own.data(), peer.data()) != 0)
    return std::nullopt;
  std::string hashed =
      with_length(kKeyDomain) + with_length(session) + with_length(text(secret)) +
      with_length(text(transcript.initiator)) + with_length(transcript.initiator_data) +
      with_length(text(transcript.responder)) + with_length(transcript.responder_data);
  const SessionKey key = sha512(hashed);
  sodium_memzero(secret.data(), secret.size());
  sodium_memzero(hashed.data(), hashed.size());
  return key;
}

}  // namespace macula::pairing
