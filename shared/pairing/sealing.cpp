#include "shared/pairing/sealing.h"

#include <sodium.h>

#include <algorithm>

namespace macula::pairing {
namespace {

constexpr std::size_t kTagBytes = crypto_auth_hmacsha512256_BYTES;
using Subkey = std::array<unsigned char, 32>;
static_assert(std::tuple_size_v<Subkey> == crypto_stream_xchacha20_KEYBYTES);
static_assert(std::tuple_size_v<Subkey> == crypto_auth_hmacsha512256_KEYBYTES);

const unsigned char* bytes_of(std::string_view text) {
  return reinterpret_cast<const unsigned char*>(text.data());
}
unsigned char* bytes_of(std::string& text) {
  return reinterpret_cast<unsigned char*>(text.data());
}

Subkey subkey(const SessionKey& key, std::string_view label) {
  Subkey out{};
  crypto_generichash(out.data(), out.size(), bytes_of(label), label.size(), key.data(), key.size());
  return out;
}

struct DirectionKeys {
  Subkey encryption, authentication;
};
DirectionKeys keys_of(const SessionKey& key, Direction direction) {
  if (direction == Direction::FromGuest)
    return {subkey(key, "guest encrypts"), subkey(key, "guest authenticates")};
  return {subkey(key, "host encrypts"), subkey(key, "host authenticates")};
}

/// The keys serve one message, so the nonce may stay zero.
std::string encrypted(std::string text, const Subkey& key) {
  const std::array<unsigned char, crypto_stream_xchacha20_NONCEBYTES> nonce{};
  crypto_stream_xchacha20_xor(bytes_of(text), bytes_of(text), text.size(), nonce.data(),
                              key.data());
  return text;
}

}  // namespace

std::string seal(const Identity& identity, const SessionKey& key, Direction direction) {
  const DirectionKeys keys = keys_of(key, direction);
  std::string plain(reinterpret_cast<const char*>(identity.key.data()), identity.key.size());
  plain += identity.name.substr(0, Identity::kMostName);
  const std::string body = encrypted(std::move(plain), keys.encryption);
  std::string sealed(kTagBytes, '\0');
  crypto_auth_hmacsha512256(bytes_of(sealed), bytes_of(std::string_view(body)), body.size(),
                            keys.authentication.data());
  return sealed + body;
}

std::optional<Identity> open_seal(std::string_view sealed, const SessionKey& key,
                                  Direction direction) {
  Identity identity;
  const std::size_t least = kTagBytes + identity.key.size();
  if (sealed.size() < least || sealed.size() > least + Identity::kMostName) return std::nullopt;
  const DirectionKeys keys = keys_of(key, direction);
  const std::string_view body = sealed.substr(kTagBytes);
  if (crypto_auth_hmacsha512256_verify(bytes_of(sealed), bytes_of(body), body.size(),
                                       keys.authentication.data()) != 0)
    return std::nullopt;
  const std::string plain = encrypted(std::string(body), keys.encryption);
  std::copy_n(plain.begin(), identity.key.size(), identity.key.begin());
  identity.name = plain.substr(identity.key.size());
  return identity;
}

}  // namespace macula::pairing
