#include "server/lights/morton.h"

#include <algorithm>
#include <array>
#include <utility>

namespace macula::lights {
namespace {

constexpr int kBitsAnAxis = 21;
constexpr int kDigitBits = 11;
constexpr int kDigits = 3;  ///< the upper ones: 11 bits an axis tell nearly all points apart
constexpr int kLowerBits = 3 * kBitsAnAxis - kDigits * kDigitBits;
constexpr std::size_t kBuckets = std::size_t{1} << kDigitBits;
using Histogram = std::array<std::uint32_t, kBuckets>;

/// Two empty places after every bit.
std::uint64_t spread(std::uint64_t x) {
  x = (x | x << 32) & 0x001F00000000FFFFULL;
  x = (x | x << 16) & 0x001F0000FF0000FFULL;
  x = (x | x << 8) & 0x100F00F00F00F00FULL;
  x = (x | x << 4) & 0x10C30C30C30C30C3ULL;
  return (x | x << 2) & 0x1249249249249249ULL;
}

std::size_t digit_of(std::uint64_t code, int digit) {
  return (code >> (kLowerBits + digit * kDigitBits)) & (kBuckets - 1);
}

struct Cube {
  DVec3 corner{0.0};
  double cells_per_meter = 0.0;  ///< 0 where all points coincide
};

Cube cube_about(std::span<const Vec3> points) {
  if (points.empty()) return {};
  Vec3 low = points.front(), high = points.front();
  for (const Vec3& point : points) low = glm::min(low, point), high = glm::max(high, point);
  const DVec3 extent = DVec3(high) - DVec3(low);
  const double side = std::max({extent.x, extent.y, extent.z});
  return {DVec3(low), side > 0.0 ? static_cast<double>(1U << kBitsAnAxis) / side : 0.0};
}

std::uint32_t cell(double coordinate) {
  constexpr std::uint32_t kLast = (1U << kBitsAnAxis) - 1U;
  return std::min(static_cast<std::uint32_t>(coordinate), kLast);
}

}  // namespace

std::uint64_t morton_code(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return spread(x) | spread(y) << 1 | spread(z) << 2;
}

std::span<const std::uint32_t> MortonOrder::sort(std::span<const Vec3> points) {
  const Cube cube = cube_about(points);
  keys_.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const DVec3 at = (DVec3(points[i]) - cube.corner) * cube.cells_per_meter;
    keys_[i] = {morton_code(cell(at.x), cell(at.y), cell(at.z)), static_cast<std::uint32_t>(i)};
  }
  sort_keys();
  order_.resize(points.size());
  for (std::size_t k = 0; k < keys_.size(); ++k) order_[k] = keys_[k].index;
  return order_;
}

/// Upper digits by radix, least significant first; a digit that all keys share is passed over. What
/// they leave equal lies in short runs, each sorted by itself.
void MortonOrder::sort_keys() {
  std::array<Histogram, kDigits> histograms{};
  for (const Key& key : keys_) {
    for (int d = 0; d < kDigits; ++d) ++histograms[d][digit_of(key.code, d)];
  }
  scratch_.resize(keys_.size());
  for (int d = 0; d < kDigits; ++d) {
    Histogram& next = histograms[d];
    if (keys_.empty() || next[digit_of(keys_.front().code, d)] == keys_.size()) continue;
    std::uint32_t before = 0;
    for (std::uint32_t& bucket : next) before += std::exchange(bucket, before);
    for (const Key& key : keys_) scratch_[next[digit_of(key.code, d)]++] = key;
    keys_.swap(scratch_);
  }
  sort_runs();
}

void MortonOrder::sort_runs() {
  const auto upper = [](const Key& key) { return key.code >> kLowerBits; };
  const auto code = [](const Key& key) { return key.code; };
  for (auto begin = keys_.begin(); begin != keys_.end();) {
    auto end = begin + 1;
    while (end != keys_.end() && upper(*end) == upper(*begin)) ++end;
    const bool ordered = std::ranges::is_sorted(begin, end, {}, code);
    if (!ordered) std::ranges::stable_sort(begin, end, {}, code);
    begin = end;
  }
}

}  // namespace macula::lights
