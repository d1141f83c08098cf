#include "server/scene/json_guard.h"

#include <algorithm>

namespace macula::scene {
namespace {

/// The position behind the string literal that opens at `quote`.
std::size_t behind_string(std::string_view text, std::size_t quote) {
  std::size_t i = quote + 1;
  while (i < text.size() && text[i] != '"') i += text[i] == '\\' ? 2 : 1;
  return i;
}

}  // namespace

JsonExtent measure_json(std::string_view text) {
  JsonExtent extent;
  std::size_t depth = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') {
      i = behind_string(text, i);
    } else if (c == '{' || c == '[') {
      ++extent.objects;
      extent.depth = std::max(extent.depth, ++depth);
    } else if (c == '}' || c == ']') {
      depth -= depth > 0 ? 1 : 0;
    } else if (c == ',') {
      ++extent.commas;
    }
  }
  return extent;
}

}  // namespace macula::scene
