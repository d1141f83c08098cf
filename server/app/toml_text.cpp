#include "server/app/toml_text.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "shared/base/text.h"
#include "shared/base/utf8.h"

namespace macula::server_app {

Result<std::string> read_toml_text(const std::string& path) {
  std::error_code ignored;
  std::ifstream file(path, std::ios::binary);
  if (!std::filesystem::is_regular_file(path, ignored) || !file)
    return base::bad_input("cannot be read", path, "give a TOML file");
  std::ostringstream bytes;
  bytes << file.rdbuf();
  std::string text = std::move(bytes).str();
  if (const auto valid = base::valid_utf8_bytes(text); valid < text.size()) {
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<long>(valid), '\n');
    return base::bad_input("is no UTF-8 text", base::concat(path, ":", line), "TOML is expected");
  }
  return text;
}

std::string first_line(std::string text) {
  return text.substr(0, text.find('\n'));
}

}  // namespace macula::server_app
