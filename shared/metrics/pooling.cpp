// From an error map to numbers.
#include <algorithm>
#include <cmath>
#include <vector>

#include "shared/metrics/flip.h"

namespace macula::metrics {
namespace {

/// The smallest error such that errors up to it make up `share` of the total; 0 where there is
/// none.
double weighted_quantile(const std::vector<float>& sorted, double total, double share) {
  double sum = 0.0;
  for (const float value : sorted) {
    sum += value;
    if (sum > share * total) return value;
  }
  return sorted.empty() ? 0.0 : sorted.back();
}

}  // namespace

ErrorSummary summarise(const Plane<float>& error_map) {
  if (error_map.empty()) return {};
  std::vector<float> sorted(error_map.pixels().begin(), error_map.pixels().end());
  double total = 0.0;
  for (const float value : sorted) total += value;
  if (std::isnan(total)) return {total, total, total, total, total, total};
  std::ranges::sort(sorted);
  return {.mean = total / static_cast<double>(sorted.size()),
          .weighted_median = weighted_quantile(sorted, total, 0.50),
          .weighted_q1 = weighted_quantile(sorted, total, 0.25),
          .weighted_q3 = weighted_quantile(sorted, total, 0.75),
          .min = sorted.front(),
          .max = sorted.back()};
}

double fraction_above(const Plane<float>& error_map, float threshold) {
  if (error_map.empty()) return 0.0;
  const auto count =
      std::ranges::count_if(error_map.pixels(), [threshold](float e) { return e > threshold; });
  return static_cast<double>(count) / static_cast<double>(error_map.size());
}

}  // namespace macula::metrics
