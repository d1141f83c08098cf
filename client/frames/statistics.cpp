#include "client/frames/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "shared/base/check.h"
#include "shared/math/hash.h"

namespace macula::frames {
namespace {

constexpr std::uint64_t kReservoirSeed = 0x5E71E5;  ///< the same run keeps the same values

}  // namespace

void Series::add(double value) {
  ++count_;
  sum_ += value;
  least_ = count_ == 1 ? value : std::min(least_, value);
  largest_ = count_ == 1 ? value : std::max(largest_, value);
  if (values_.size() < kMost) {
    values_.push_back(value);
    return;
  }
  const std::uint64_t place = math::hash_combine(kReservoirSeed, count_) % count_;
  if (place < kMost) values_[place] = value;
}

double Series::quantile(double q) const {
  MACULA_CHECK(q >= 0.0 && q <= 1.0, "a quantile lies in [0, 1]");
  if (values_.empty()) return 0.0;
  if (q == 0.0) return least_;
  if (q == 1.0) return largest_;
  std::vector<double> sorted = values_;
  std::sort(sorted.begin(), sorted.end());
  const double place = q * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const auto above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], place - static_cast<double>(below));
}

double Series::mean() const {
  return count_ == 0 ? 0.0 : sum_ / static_cast<double>(count_);
}

}  // namespace macula::frames
