#include "server/reconstruction/axis_locator.h"

#include <algorithm>
#include <cmath>

#include "shared/base/check.h"

namespace macula::reconstruction {
namespace {

constexpr double kMostBuckets = 1 << 16;

float smallest_step(const std::vector<float>& edges) {
  float least = edges[1] - edges[0];
  for (std::size_t i = 1; i + 1 < edges.size(); ++i) {
    least = std::min(least, edges[i + 1] - edges[i]);
  }
  return least;
}

/// Every edge within a hundredth of a cell of where equal steps would have it.
bool has_equal_steps(const std::vector<float>& edges) {
  const double step =
      (static_cast<double>(edges.back()) - edges.front()) / static_cast<double>(edges.size() - 1);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const double expected = edges.front() + step * static_cast<double>(i);
    if (std::abs(edges[i] - expected) > 0.01 * step) return false;
  }
  return true;
}

}  // namespace

AxisLocator::AxisLocator(const std::vector<float>& edges) : first_(edges.front()), per_tangent_() {
  MACULA_CHECK(edges.size() >= 2);
  const double extent = static_cast<double>(edges.back()) - edges.front();
  if (has_equal_steps(edges)) {
    per_tangent_ = static_cast<float>(static_cast<double>(edges.size() - 1) / extent);
    return;
  }
  const double buckets = std::min(std::ceil(4.0 * extent / smallest_step(edges)), kMostBuckets);
  per_tangent_ = static_cast<float>(buckets / extent);
  std::size_t cell = 0;
  for (int b = 0; b <= static_cast<int>(buckets); ++b) {
    const double tangent = edges.front() + extent * b / buckets;
    while (cell + 2 < edges.size() && edges[cell + 1] <= tangent) ++cell;
    const double step = static_cast<double>(edges[cell + 1]) - edges[cell];
    table_.push_back(
        static_cast<float>(static_cast<double>(cell) + (tangent - edges[cell]) / step));
  }
}

float AxisLocator::locate(float tangent) const {
  const float place = (tangent - first_) * per_tangent_;
  if (equal_steps()) return place;
  const float last = static_cast<float>(table_.size() - 2);
  const float bucket = std::clamp(std::floor(place), 0.0F, last);
  const auto index = static_cast<std::size_t>(bucket);
  return table_[index] + (place - bucket) * (table_[index + 1] - table_[index]);
}

}  // namespace macula::reconstruction
