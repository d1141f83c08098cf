// The six digits a person reads on one machine and types on the other.
#pragma once

#include <string>
#include <string_view>

#include "shared/base/result.h"
#include "shared/pairing/random.h"

namespace macula::pairing {

class Code {
 public:
  static constexpr std::size_t kDigits = 6;

  /// Uniform over 000000..999999.
  static Code draw(const Random& random);
  /// As typed: six digits; spaces and dashes between them do not count.
  static Result<Code> parse(std::string_view typed);

  const std::string& digits() const { return digits_; }
  /// "123 456", as it is shown.
  std::string spaced() const;
  friend bool operator==(const Code&, const Code&) = default;

 private:
  explicit Code(std::string digits) : digits_(std::move(digits)) {}
  std::string digits_;
};

}  // namespace macula::pairing
