// Outside data (scenes, traces, references) lies beside the checkout; tests that use it skip by name
// where it is absent. The product never reads it.
#pragma once

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

namespace macula::test {

inline std::filesystem::path handed_data() {
  return std::filesystem::path(MACULA_SOURCE_DIR) / ".." / "shared" / "data";
}

}  // namespace macula::test

/// Skips the running test, naming what is missing.
#define MACULA_NEEDS_HANDED_DATA(relative)                                             \
  if (!std::filesystem::exists(::macula::test::handed_data() / (relative)))            \
  GTEST_SKIP() << "outside data is absent: " << (::macula::test::handed_data() / (relative)).string()
