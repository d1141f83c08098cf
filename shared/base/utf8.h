// Whether bytes are text.
#pragma once

#include <cstddef>
#include <string_view>

namespace macula::base {

/// Bytes of the longest beginning that is well-formed UTF-8 (Unicode 15, table 3-7): no overlong
/// forms, no surrogates, nothing beyond U+10FFFF. Equals text.size() where all of it is.
std::size_t valid_utf8_bytes(std::string_view text);

}  // namespace macula::base
