// Integer hashes for deterministic sampling: a sample is a pure function of (seed, frame, cell,
// dimension). The finaliser is SplitMix64's (Steele, Lea, Flood 2014).
#pragma once

#include <cstdint>

namespace macula::math {

constexpr std::uint64_t hash_mix(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}
constexpr std::uint64_t hash_combine(std::uint64_t a, std::uint64_t b) {
  return hash_mix(hash_mix(a) ^ b);
}
/// In [0, 1): the top 24 bits, exactly representable.
constexpr float unit_float(std::uint64_t hash) {
  return static_cast<float>(hash >> 40) * 0x1p-24F;
}

}  // namespace macula::math
