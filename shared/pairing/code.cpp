#include "shared/pairing/code.h"

#include <array>
#include <cstdint>
#include <cstring>

namespace macula::pairing {

Code Code::draw(const Random& random) {
  constexpr std::uint32_t kCodes = 1'000'000;
  // The largest multiple of kCodes in 32 bits: above it a remainder would favour small codes.
  constexpr std::uint32_t kFair = 0xFFFFFFFFU / kCodes * kCodes;
  std::uint32_t bits = kFair;
  while (bits >= kFair) {
    std::array<unsigned char, sizeof bits> bytes{};
    random(bytes);
    std::memcpy(&bits, bytes.data(), sizeof bits);
  }
  std::string digits = std::to_string(bits % kCodes);
  return Code(std::string(kDigits - digits.size(), '0') + digits);
}

Result<Code> Code::parse(std::string_view typed) {
  std::string digits;
  for (const char c : typed) {
    if (c >= '0' && c <= '9' && digits.size() <= kDigits)
      digits.push_back(c);
    else if (c != ' ' && c != '-')
      return base::bad_input("a pairing code has digits only", "code", "six digits");
  }
  if (digits.size() != kDigits)
    return base::bad_input("not a pairing code", "code", "six digits, as the server shows them");
  return Code(std::move(digits));
}

std::string Code::spaced() const {
  return digits_.substr(0, kDigits / 2) + " " + digits_.substr(kDigits / 2);
}

}  // namespace macula::pairing
