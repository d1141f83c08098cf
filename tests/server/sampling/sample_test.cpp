#include "server/sampling/sample.h"

#include <gtest/gtest.h>

#include "tests/server/sampling/chi_square.h"

namespace macula::sampling {
namespace {

using test::chi_square_excess;
using test::count_on_square;
using test::kDefect;

constexpr int kDraws = 200'000;

TEST(Sample, IsAPureFunctionOfItsFourArguments) {
  EXPECT_EQ(sample(1, 2, 3, 4), sample(1, 2, 3, 4));
  EXPECT_NE(sample(1, 2, 3, 4), sample(9, 2, 3, 4));
  EXPECT_NE(sample(1, 2, 3, 4), sample(1, 9, 3, 4));
  EXPECT_NE(sample(1, 2, 3, 4), sample(1, 2, 9, 4));
  EXPECT_NE(sample(1, 2, 3, 4), sample(1, 2, 3, 9));
}

TEST(Sample, LiesInTheHalfOpenUnitInterval) {
  for (std::uint64_t cell = 0; cell < 100'000; ++cell) {
    const float value = sample(7, 0, cell, 0);
    ASSERT_GE(value, 0.0F);
    ASSERT_LT(value, 1.0F);
  }
}

TEST(Sample, NeighbouringCellsFramesAndDimensionsAreIndependent) {
  // Pairs of values one step apart along each argument fill the square evenly.
  const auto by_cell = count_on_square(kDraws, [](int i) {
    const auto cell = static_cast<std::uint64_t>(i);
    return Vec2{sample(1, 0, cell, 0), sample(1, 0, cell + 1, 0)};
  });
  const auto by_frame = count_on_square(kDraws, [](int i) {
    const auto frame = static_cast<std::uint64_t>(i);
    return Vec2{sample(1, frame, 5, 0), sample(1, frame + 1, 5, 0)};
  });
  const auto by_dimension = count_on_square(
      kDraws, [](int i) { return sample_2d(SampleKey(1, 0, static_cast<std::uint64_t>(i)), 0); });
  EXPECT_LT(chi_square_excess(by_cell), kDefect);
  EXPECT_LT(chi_square_excess(by_frame), kDefect);
  EXPECT_LT(chi_square_excess(by_dimension), kDefect);
}

TEST(Sample, ExchangedArgumentsGiveUnrelatedValuesUnlikeAnXorOfThem) {
  const auto right = count_on_square(kDraws, [](int i) {
    const auto n = static_cast<std::uint64_t>(i);
    return Vec2{sample(1, n, n + 1, 0), sample(1, n + 1, n, 0)};
  });
  EXPECT_LT(chi_square_excess(right), kDefect);
  // The wrong twin hashes seed ^ frame ^ cell, which cannot tell frame from cell.
  const auto twin = [](std::uint64_t seed, std::uint64_t frame, std::uint64_t cell) {
    return math::unit_float(math::hash_mix(seed ^ frame ^ cell));
  };
  const auto wrong = count_on_square(kDraws, [&](int i) {
    const auto n = static_cast<std::uint64_t>(i);
    return Vec2{twin(1, n, n + 1), twin(1, n + 1, n)};
  });
  EXPECT_GT(chi_square_excess(wrong), kDefect);
}

TEST(Sample, MeanAndVarianceAreThoseOfTheUniformDistribution) {
  double sum = 0.0, squares = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double value = sample(3, 0, static_cast<std::uint64_t>(i), 0);
    sum += value;
    squares += value * value;
  }
  const double mean = sum / kDraws, variance = squares / kDraws - mean * mean;
  EXPECT_NEAR(mean, 0.5, 5.0 * std::sqrt(1.0 / 12.0 / kDraws));
  EXPECT_NEAR(variance, 1.0 / 12.0, 5.0 * std::sqrt(1.0 / 180.0 / kDraws));
}

}  // namespace
}  // namespace macula::sampling
