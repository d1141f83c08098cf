#include "shared/pairing/random.h"

#include <sodium.h>

#include "shared/base/check.h"

namespace macula::pairing {

Random system_random() {
  MACULA_CHECK(sodium_init() >= 0, "libsodium finds no source of random bytes");
  return [](std::span<unsigned char> bytes) { randombytes_buf(bytes.data(), bytes.size()); };
}

}  // namespace macula::pairing
