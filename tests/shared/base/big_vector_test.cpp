#include "shared/base/big_vector.h"

#include <cstdint>

#include <gtest/gtest.h>

namespace macula::base {
namespace {

struct alignas(64) Line {
  std::uint64_t value = 7;
};

TEST(BigVector, KeepsValuesAndAlignmentWhileItGrowsOverManyPages) {
  BigVector<Line> lines;
  for (std::uint64_t i = 0; i < 100'000; ++i) lines.push_back({i});
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(lines.data()) % alignof(Line), 0U);
  std::uint64_t sum = 0;
  for (const Line& line : lines) sum += line.value;
  EXPECT_EQ(sum, std::uint64_t{100'000} * 99'999 / 2);
  const BigVector<Line> copy = lines;
  lines.clear();
  EXPECT_EQ(copy[99'999].value, 99'999U);
  lines.resize(3);
  EXPECT_EQ(lines[2].value, 7U);
}

TEST(BigVector, SmallOnesAreVectorsLikeOthers) {
  BigVector<char> letters(3, 'a');
  letters.resize(5);
  EXPECT_EQ(letters.back(), '\0');
  EXPECT_TRUE(BigVector<int>().empty());
}

}  // namespace
}  // namespace macula::base
