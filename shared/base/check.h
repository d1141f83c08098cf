// MACULA_CHECK: a violated condition is our bug; it prints the condition and place, then aborts.
#pragma once

#include <string>

namespace macula::base {
[[noreturn]] void check_failed(const char* condition, const char* file, int line,
                               const std::string& message);
}

#define MACULA_CHECK(condition, ...)                                                            \
  do {                                                                                          \
    if (!(condition)) [[unlikely]]                                                              \
      ::macula::base::check_failed(#condition, __FILE__, __LINE__, ::std::string{__VA_ARGS__}); \
  } while (false)

#ifdef NDEBUG
#define MACULA_DCHECK(condition, ...) \
  do {                                \
  } while (false)
#else
#define MACULA_DCHECK(condition, ...) MACULA_CHECK(condition, __VA_ARGS__)
#endif
