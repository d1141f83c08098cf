#include "server/lights/morton.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "server/lights/morton_simd.h"

namespace macula::lights {
namespace {

constexpr int kIndexBits = 32;
constexpr int kDigitBits = 11;
constexpr int kDigits = 2;
constexpr int kRestBits = kKeyBits - kDigits * kDigitBits;  ///< of a key, below its two digits
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
  return (key >> (kIndexBits + kRestBits + digit * kDigitBits)) & (kBuckets - 1);
}
/// What the two digits see of a key.
std::uint64_t digits_of(std::uint64_t key) {
  return key >> (kIndexBits + kRestBits);
}
std::uint64_t upper_bits(std::uint64_t key) {
  return key >> kIndexBits;
}

/// Counts become places.
void place_buckets(std::span<std::uint32_t> counts) {
  std::uint32_t before = 0;
  for (std::uint32_t& bucket : counts) before += std::exchange(bucket, before);
}

/// By the bits below the two digits, in one pass; `spare` is as large.
void sort_by_rest(std::span<std::uint64_t> keys, std::span<std::uint64_t> spare) {
  constexpr std::size_t kRests = std::size_t{1} << kRestBits;
  const auto rest_of = [](std::uint64_t key) { return (key >> kIndexBits) & (kRests - 1); };
  std::array<std::uint32_t, kRests> next{};
  for (const std::uint64_t key : keys) ++next[rest_of(key)];
  place_buckets(next);
  for (const std::uint64_t key : keys) spare[next[rest_of(key)]++] = key;
  std::ranges::copy(spare, keys.begin());
}

/// Equal upper bits, in the order of their indices: by their whole codes.
void sort_by_code(std::span<std::uint64_t> keys, std::span<const Vec4> points,
                  const MortonCube& cube) {
  std::vector<std::pair<std::uint64_t, std::uint64_t>> by_code;
  by_code.reserve(keys.size());
  for (const std::uint64_t key : keys) {
    by_code.emplace_back(morton_code(points[static_cast<std::uint32_t>(key)], cube), key);
  }
  if (std::ranges::is_sorted(by_code)) return;
  std::ranges::sort(by_code);
  std::ranges::transform(by_code, keys.begin(), [](const auto& pair) { return pair.second; });
}

/// Where keys that are sorted have equal upper bits.
void sort_equals(std::span<std::uint64_t> keys, std::span<const Vec4> points,
                 const MortonCube& cube) {
  for (std::size_t k = 1; k < keys.size(); ++k) {
    if (upper_bits(keys[k]) != upper_bits(keys[k - 1])) [[likely]]
      continue;
    const std::size_t begin = k - 1;
    while (k < keys.size() && upper_bits(keys[k]) == upper_bits(keys[begin])) ++k;
    sort_by_code(keys.subspan(begin, k - begin), points, cube);
  }
}

}  // namespace

std::uint64_t morton_code(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return spread(x) | spread(y) << 1 | spread(z) << 2;
}

std::uint64_t morton_code(const Vec4& point, const MortonCube& cube) {
  const auto cell = [&](float at, double corner) {
    constexpr std::uint32_t kLast = (1U << kMortonBits) - 1;
    const double cells = (static_cast<double>(at) - corner) * cube.cells_per_meter;
    return std::min(static_cast<std::uint32_t>(cells), kLast);
  };
  return morton_code(cell(point.x, cube.corner.x), cell(point.y, cube.corner.y),
                     cell(point.z, cube.corner.z));
}

MortonCube cube_about(const Vec3& low, const Vec3& high) {
  const DVec3 extent = DVec3(high) - DVec3(low);
  const double side = std::max({extent.x, extent.y, extent.z});
  return {DVec3(low), side > 0.0 ? static_cast<double>(1U << kMortonBits) / side : 0.0};
}

void MortonOrder::sort(std::span<const Vec4> points, const MortonCube& cube,
                       base::BigVector<std::uint32_t>& order) {
  keys_.resize(points.size());
  scratch_.resize(points.size());
  morton_keys(points, cube, keys_);
  sort_by_digits();
  sort_rest();
  sort_equals(keys_, points, cube);
  order.resize(points.size());
  std::ranges::transform(keys_, order.begin(),
                         [](std::uint64_t key) { return static_cast<std::uint32_t>(key); });
}

/// By radix, the less significant digit first; one that all keys share is passed over.
void MortonOrder::sort_by_digits() {
  std::array<Histogram, kDigits> histograms{};
  for (const std::uint64_t key : keys_) {
    for (int d = 0; d < kDigits; ++d) ++histograms[d][digit_of(key, d)];
  }
  for (int d = 0; d < kDigits; ++d) {
    Histogram& next = histograms[d];
    if (keys_.empty() || next[digit_of(keys_.front(), d)] == keys_.size()) continue;
    place_buckets(next);
    for (const std::uint64_t key : keys_) scratch_[next[digit_of(key, d)]++] = key;
    keys_.swap(scratch_);
  }
}

/// Keys are in the order of their digits: what is still out of order is a few places away, or in a
/// run of many whose digits are equal.
void MortonOrder::sort_rest() {
  constexpr std::size_t kShort = 24;
  for (std::size_t k = 1; k < keys_.size(); ++k) {
    const std::uint64_t key = keys_[k];
    if (keys_[k - 1] <= key) [[likely]]
      continue;
    const std::size_t least = std::max(k, kShort) - kShort;
    std::size_t to = k;
    for (; to > least && keys_[to - 1] > key; --to) keys_[to] = keys_[to - 1];
    keys_[to] = key;
    if (to == least && to > 0 && keys_[to - 1] > key) k = sort_run_at(k) - 1;
  }
}

/// All keys with the digits of the k-th, which some of them may have been moved among; their end.
std::size_t MortonOrder::sort_run_at(std::size_t k) {
  std::size_t begin = k, end = k + 1;
  while (begin > 0 && digits_of(keys_[begin - 1]) == digits_of(keys_[k])) --begin;
  while (end < keys_.size() && digits_of(keys_[end]) == digits_of(keys_[k])) ++end;
  const auto run = std::span(keys_).subspan(begin, end - begin);
  constexpr std::size_t kLong = 512;
  if (run.size() <= kLong) {
    std::ranges::sort(run);
  } else {
    sort_by_rest(run, std::span(scratch_).subspan(begin, run.size()));
  }
  return end;
}

}  // namespace macula::lights
