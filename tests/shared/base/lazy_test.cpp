#include "shared/base/lazy.h"

#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace macula::base {
namespace {

TEST(Lazy, IsMadeOnceByWhoeverAsksFirst) {
  Lazy<std::vector<int>> lazy;
  std::atomic<int> made{0}, seen{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      const std::vector<int>& value = lazy.get([&](std::vector<int>& fresh) {
        ++made;
        fresh.assign(1000, 7);
      });
      if (value.size() == 1000 && value.back() == 7) ++seen;
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(made, 1);
  EXPECT_EQ(seen, 4);
}

TEST(Lazy, IsMadeAgainAfterAResetAndInACopy) {
  Lazy<int> lazy;
  int makes = 0;
  const auto count = [&](int& value) { value = ++makes; };
  EXPECT_EQ(lazy.get(count), 1);
  EXPECT_EQ(lazy.get(count), 1);
  lazy.reset();
  EXPECT_EQ(lazy.get(count), 2);
  const Lazy<int> copy = lazy;
  EXPECT_EQ(copy.get(count), 3);
  EXPECT_EQ(lazy.get(count), 2);
}

}  // namespace
}  // namespace macula::base
