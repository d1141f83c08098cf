#include "server/sampling/sobol.h"

#include <gtest/gtest.h>

#include <set>

#include "server/sampling/sample.h"
#include "tests/server/sampling/chi_square.h"

namespace macula::sampling {
namespace {

/// Boxes of 2^-a x 2^-b, a + b = m, over every split, that do not hold exactly one of 2^m points.
template <class Point>
int wrong_boxes(int m, std::uint32_t first, Point&& point) {
  int wrong = 0;
  for (int a = 0; a <= m; ++a) {
    const int columns = 1 << a, rows = 1 << (m - a);
    std::vector<int> count(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 0);
    for (std::uint32_t i = 0; i < (1U << m); ++i) {
      const Vec2 p = point(first + i);
      const int x = static_cast<int>(p.x * static_cast<float>(columns));
      const int y = static_cast<int>(p.y * static_cast<float>(rows));
      ++count.at(static_cast<std::size_t>(y * columns + x));
    }
    for (const int n : count) wrong += n == 1 ? 0 : 1;
  }
  return wrong;
}

TEST(SobolOwen, EveryElementaryIntervalHoldsExactlyOnePoint) {
  for (const std::uint32_t seed : {0U, 1U, 12345U, 0xFFFFFFFFU})
    for (int m = 0; m <= 10; ++m)
      EXPECT_EQ(wrong_boxes(m, 0, [&](std::uint32_t i) { return sobol_owen_2d(i, seed); }), 0)
          << "seed " << seed << ", " << (1 << m) << " points";
}

TEST(SobolOwen, LaterAlignedBlocksAreNetsToo) {
  for (const std::uint32_t block : {1U, 2U, 77U})
    EXPECT_EQ(wrong_boxes(6, block << 6, [](std::uint32_t i) { return sobol_owen_2d(i, 9); }), 0);
}

TEST(SobolOwen, IndependentPointsFailTheIntervalTest) {
  EXPECT_GT(wrong_boxes(6, 0, [](std::uint32_t i) { return sample_2d(SampleKey(1, 0, i), 0); }),
            50);
}

TEST(SobolOwen, OnePointOverManySeedsIsUniform) {
  // What makes the estimate of a scrambled sequence unbiased.
  for (const std::uint32_t index : {0U, 1U, 5U, 1000U}) {
    const auto counts = test::count_on_square(
        100'000, [&](int seed) { return sobol_owen_2d(index, static_cast<std::uint32_t>(seed)); });
    EXPECT_LT(test::chi_square_excess(counts), test::kDefect) << "index " << index;
  }
}

TEST(SobolOwen, PairsOfSequencesFillFourDimensionsEvenly) {
  // The first coordinates of two differently seeded sequences: independent over many seeds.
  const auto counts = test::count_on_square(100'000, [](int seed) {
    const SampleKey key(1, 0, static_cast<std::uint64_t>(seed));
    return Vec2{sobol_owen_2d(3, scramble_seed(key, 0)).x,
                sobol_owen_2d(3, scramble_seed(key, 2)).x};
  });
  EXPECT_LT(test::chi_square_excess(counts), test::kDefect);
}

TEST(SobolOwen, IntegratesASmoothFunctionFarBetterThanIndependentSamples) {
  // The integral of x y over the square is 1/4. Scrambled nets: error O(n^-1.5), independent
  // O(n^-0.5).
  constexpr int kPoints = 256, kSeeds = 50;
  double net = 0.0, independent = 0.0;
  for (std::uint32_t seed = 0; seed < kSeeds; ++seed) {
    double a = 0.0, b = 0.0;
    for (std::uint32_t i = 0; i < kPoints; ++i) {
      const Vec2 p = sobol_owen_2d(i, seed), q = sample_2d(SampleKey(seed, 1, i), 0);
      a += static_cast<double>(p.x) * p.y;
      b += static_cast<double>(q.x) * q.y;
    }
    net += std::pow(a / kPoints - 0.25, 2);
    independent += std::pow(b / kPoints - 0.25, 2);
  }
  EXPECT_LT(100.0 * net, independent);
}

}  // namespace
}  // namespace macula::sampling
