// One log for the process, on stderr. Thread-safe. Levels: trace < info < warning < error.
#pragma once

#include <string_view>

namespace macula::base {

enum class LogLevel { Trace, Info, Warning, Error, Off };

void set_log_level(LogLevel level);
void log(LogLevel level, std::string_view message);
inline void log_trace(std::string_view message) {
  log(LogLevel::Trace, message);
}
inline void log_info(std::string_view message) {
  log(LogLevel::Info, message);
}
inline void log_warning(std::string_view message) {
  log(LogLevel::Warning, message);
}
inline void log_error(std::string_view message) {
  log(LogLevel::Error, message);
}

}  // namespace macula::base
