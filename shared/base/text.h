// concat("frame ", 3, " took ", 2.5, " ms"): building a message from values, nothing more.
#pragma once

#include <sstream>
#include <string>

namespace macula::base {

template <class... Parts>
std::string concat(const Parts&... parts) {
  std::ostringstream out;
  (out << ... << parts);
  return std::move(out).str();
}

}  // namespace macula::base
