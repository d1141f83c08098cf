// What reading any TOML file of the server begins and ends with.
#pragma once

#include <string>

#include "shared/base/result.h"

namespace macula::server_app {

/// The whole file. Errors: it cannot be read, or a line that is no UTF-8, which the parser would
/// read beyond its memory (toml11 3.7.1).
Result<std::string> read_toml_text(const std::string& path);
/// Of a parser's explanation over several lines, the one that says what is wrong.
std::string first_line(std::string text);

}  // namespace macula::server_app
