// Pearson's test of counts against equal expectation, for samples that should be uniform over bins.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace macula::sampling::test {

/// How many standard deviations chi^2 lies above its mean, k - 1, for k equally likely bins. Beyond
/// 6 is a defect (p < 1e-6 for k >= 16); uniform samples stay within +-4.
inline double chi_square_excess(const std::vector<int>& counts) {
  double total = 0.0;
  for (const int n : counts) total += n;
  const double expected = total / static_cast<double>(counts.size());
  double chi_square = 0.0;
  for (const int n : counts) chi_square += (n - expected) * (n - expected) / expected;
  const double freedom = static_cast<double>(counts.size()) - 1.0;
  return (chi_square - freedom) / std::sqrt(2.0 * freedom);
}
inline constexpr double kDefect = 6.0;

/// Counts `draws` values of make(i) in [0, 1)^2 on a kSide x kSide raster.
template <class Make>
std::vector<int> count_on_square(int draws, Make&& make) {
  constexpr int kSide = 16;
  std::vector<int> counts(kSide * kSide, 0);
  for (int i = 0; i < draws; ++i) {
    const auto point = make(i);
    const int x = static_cast<int>(point.x * kSide), y = static_cast<int>(point.y * kSide);
    ++counts.at(static_cast<std::size_t>(y * kSide + x));
  }
  return counts;
}

}  // namespace macula::sampling::test
