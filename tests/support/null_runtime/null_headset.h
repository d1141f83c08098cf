// For tests with a headset that exists only in them: opens the null runtime that the loader will
// find too, hands out its script, and a hidden OpenGL context where there is a display.
#pragma once

#include <dlfcn.h>

#include <gtest/gtest.h>
#include <cstdlib>
#include <memory>

#include "client/display/window/hidden_context.h"
#include "tests/support/null_runtime/null_runtime.h"

namespace macula::test {

/// The runtime of this process, scripted afresh.
inline NullRuntime& fresh_null_runtime() {
  void* const library = ::dlopen(MACULA_NULL_RUNTIME, RTLD_NOW | RTLD_LOCAL);
  const auto find = reinterpret_cast<NullRuntime* (*)()>(
      library != nullptr ? ::dlsym(library, "macula_null_runtime") : nullptr);
  if (find == nullptr) std::abort();
  NullRuntime& runtime = *find();
  const std::lock_guard held(runtime.mutex);
  runtime.script = NullScript{};
  runtime.frames.clear();
  runtime.misuses = runtime.live_handles = 0;
  runtime.first_misuse.clear();
  return runtime;
}

class NullHeadsetTest : public testing::Test {
 protected:
  void SetUp() override {
    auto context = display::HiddenContext::create();
    if (context) return;
    ASSERT_EQ(std::getenv("MACULA_TEST_HAS_DISPLAY"), nullptr) << context.error().message();
    GTEST_SKIP() << context.error().message();
  }
  /// Everything given back, in the specification's order of calls.
  void TearDown() override {
    EXPECT_EQ(runtime_.misuses, 0) << runtime_.first_misuse;
    EXPECT_EQ(runtime_.live_handles, 0);
  }

  NullRuntime& runtime_ = fresh_null_runtime();
};

}  // namespace macula::test
