#include "server/lights/morton.h"

#include <algorithm>
#include <array>
#include <utility>

#include "server/lights/morton_simd.h"

namespace macula::lights {
namespace {

constexpr int kLowerBits = 31;  ///< the 32 above them tell nearly all points apart
constexpr int kIndexBits = 32;
constexpr int kDigitBits = 11;
constexpr int kDigits = 3;
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

std::size_t digit_of(std::uint64_t key, int digit) {
  return (key >> (kIndexBits + digit * kDigitBits)) & (kBuckets - 1);
}

MortonCube cube_about(std::span<const Vec3> points) {
  if (points.empty()) return {};
  Vec3 low = points.front(), high = points.front();
  for (const Vec3& point : points) low = glm::min(low, point), high = glm::max(high, point);
  const DVec3 extent = DVec3(high) - DVec3(low);
  const double side = std::max({extent.x, extent.y, extent.z});
  return {DVec3(low), side > 0.0 ? static_cast<double>(1U << kMortonBits) / side : 0.0};
}

}  // namespace

std::uint64_t morton_code(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return spread(x) | spread(y) << 1 | spread(z) << 2;
}

std::span<const std::uint32_t> MortonOrder::sort(std::span<const Vec3> points) {
  codes_.resize(points.size());
  morton_codes(points, cube_about(points), codes_);
  keys_.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    keys_[i] = codes_[i] >> kLowerBits << kIndexBits | i;
  }
  sort_upper_bits();
  order_.resize(points.size());
  for (std::size_t k = 0; k < keys_.size(); ++k) order_[k] = static_cast<std::uint32_t>(keys_[k]);
  sort_runs();
  return order_;
}

/// By radix, the least significant digit first; a digit that all keys share is passed over.
void MortonOrder::sort_upper_bits() {
  std::array<Histogram, kDigits> histograms{};
  for (const std::uint64_t key : keys_) {
    for (int d = 0; d < kDigits; ++d) ++histograms[d][digit_of(key, d)];
  }
  scratch_.resize(keys_.size());
  for (int d = 0; d < kDigits; ++d) {
    Histogram& next = histograms[d];
    if (keys_.empty() || next[digit_of(keys_.front(), d)] == keys_.size()) continue;
    std::uint32_t before = 0;
    for (std::uint32_t& bucket : next) before += std::exchange(bucket, before);
    for (const std::uint64_t key : keys_) scratch_[next[digit_of(key, d)]++] = key;
    keys_.swap(scratch_);
  }
}

/// What the upper bits leave equal lies in short runs, each sorted by itself.
void MortonOrder::sort_runs() {
  const auto upper = [&](std::size_t k) { return keys_[k] >> kIndexBits; };
  const auto code = [&](std::uint32_t index) { return codes_[index]; };
  for (std::size_t begin = 0; begin < keys_.size();) {
    std::size_t end = begin + 1;
    while (end < keys_.size() && upper(end) == upper(begin)) ++end;
    if (end - begin > 1) {
      const auto first = order_.begin() + static_cast<std::ptrdiff_t>(begin);
      const auto last = order_.begin() + static_cast<std::ptrdiff_t>(end);
      if (!std::ranges::is_sorted(first, last, {}, code)) {
        std::ranges::stable_sort(first, last, {}, code);
      }
    }
    begin = end;
  }
}

}  // namespace macula::lights
