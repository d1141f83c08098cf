#include "shared/base/utf8.h"

#include <array>

namespace macula::base {
namespace {

struct Range {
  unsigned char first, last;
  bool holds(char byte) const {
    const auto value = static_cast<unsigned char>(byte);
    return value >= first && value <= last;
  }
};

constexpr Range kTail{0x80, 0xBF};

/// A row of Unicode's table 3-7: the first byte, the second, and how many there are.
struct Form {
  Range lead, second;
  std::size_t bytes;
};
constexpr std::array kForms{
    Form{{0x00, 0x7F}, kTail, 1},        Form{{0xC2, 0xDF}, kTail, 2},
    Form{{0xE0, 0xE0}, {0xA0, 0xBF}, 3}, Form{{0xE1, 0xEC}, kTail, 3},
    Form{{0xED, 0xED}, {0x80, 0x9F}, 3}, Form{{0xEE, 0xEF}, kTail, 3},
    Form{{0xF0, 0xF0}, {0x90, 0xBF}, 4}, Form{{0xF1, 0xF3}, kTail, 4},
    Form{{0xF4, 0xF4}, {0x80, 0x8F}, 4},
};

bool begins_with(std::string_view text, const Form& form) {
  if (text.size() < form.bytes || !form.lead.holds(text[0])) return false;
  if (form.bytes > 1 && !form.second.holds(text[1])) return false;
  for (std::size_t i = 2; i < form.bytes; ++i)
    if (!kTail.holds(text[i])) return false;
  return true;
}

/// Of the character that the text begins with; 0: it is none.
std::size_t character_bytes(std::string_view text) {
  for (const Form& form : kForms)
    if (begins_with(text, form)) return form.bytes;
  return 0;
}

}  // namespace

std::size_t valid_utf8_bytes(std::string_view text) {
  std::size_t valid = 0;
  while (valid < text.size()) {
    const std::size_t bytes = character_bytes(text.substr(valid));
    if (bytes == 0) break;
    valid += bytes;
  }
  return valid;
}

}  // namespace macula::base
