#include "shared/base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace macula::base {
namespace {

TEST(Parallel, EveryIndexIsCalledOnce) {
  std::vector<int> calls(1000, 0);
  for_each_index(calls.size(), [&](std::size_t i) { ++calls[i]; });
  EXPECT_EQ(calls, std::vector<int>(1000, 1));
}

TEST(Parallel, NothingIsCalledOfNothing) {
  for_each_index(0, [](std::size_t) { FAIL(); });
}

TEST(Parallel, AnExceptionArrivesAndEndsTheRest) {
  std::atomic<int> calls{0};
  const auto fail = [&](std::size_t) {
    ++calls;
    throw std::runtime_error("no memory");
  };
  EXPECT_THROW(for_each_index(100'000, fail), std::runtime_error);
  EXPECT_LT(calls, 100'000);
}

}  // namespace
}  // namespace macula::base
