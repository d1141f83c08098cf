#include "client/frames/statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "shared/base/check.h"

namespace macula::frames {

double Series::quantile(double q) const {
  MACULA_CHECK(q >= 0.0 && q <= 1.0, "a quantile lies in [0, 1]");
  if (values_.empty()) return 0.0;
  std::vector<double> sorted = values_;
  std::sort(sorted.begin(), sorted.end());
  const double place = q * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const auto above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], place - static_cast<double>(below));
}

double Series::mean() const {
  if (values_.empty()) return 0.0;
  return std::accumulate(values_.begin(), values_.end(), 0.0) / static_cast<double>(values_.size());
}

double Series::largest() const {
  return quantile(1.0);
}

}  // namespace macula::frames
