#include "shared/math/hash.h"

#include <gtest/gtest.h>

#include <array>

namespace macula::math {
namespace {

TEST(Hash, UnitFloatStaysBelowOneForTheLargestHash) {
  EXPECT_LT(unit_float(~0ULL), 1.0F);
  EXPECT_EQ(unit_float(0), 0.0F);
}

// 64 bins, 64,000 draws: chi-square with 63 degrees of freedom exceeds 117 with probability 4e-5.
double chi_square(std::uint64_t (*hash)(std::uint64_t)) {
  std::array<int, 64> counts{};
  for (std::uint64_t i = 0; i < 64000; ++i) {
    ++counts[static_cast<std::size_t>(unit_float(hash(i)) * 64.0F)];
  }
  double sum = 0.0;
  for (const int count : counts) sum += (count - 1000.0) * (count - 1000.0) / 1000.0;
  return sum;
}

TEST(Hash, ConsecutiveKeysSpreadEvenly) {
  EXPECT_LT(chi_square(&hash_mix), 117.0);
}

TEST(Hash, TheEvennessTestRejectsAHashThatLosesItsLowBits) {
  EXPECT_GT(chi_square([](std::uint64_t x) -> std::uint64_t { return hash_mix(x >> 8); }), 117.0);
}

TEST(Hash, CombineDependsOnTheOrderOfItsArguments) {
  EXPECT_NE(hash_combine(1, 2), hash_combine(2, 1));
}

}  // namespace
}  // namespace macula::math
