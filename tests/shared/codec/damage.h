// Deliberate damage to coded bytes, the same for every codec: truncations and seeded bit flips.
#pragma once

#include <cstddef>
#include <functional>
#include <random>
#include <span>
#include <vector>

namespace macula::codec {

/// How many damaged versions a decoder refused and how many it took for valid.
struct DamageCount {
  int refused = 0, accepted = 0;
};

using TryDecode = std::function<bool(std::span<const std::byte>)>;

inline DamageCount flip_bits(const std::vector<std::byte>& whole, int times, unsigned seed,
                             const TryDecode& decodes) {
  std::mt19937 random(seed);
  DamageCount count;
  for (int i = 0; i < times; ++i) {
    auto bytes = whole;
    for (auto flips = 1 + random() % 3; flips > 0; --flips)
      bytes[random() % bytes.size()] ^= static_cast<std::byte>(1U << (random() % 8));
    ++(decodes(bytes) ? count.accepted : count.refused);
  }
  return count;
}

inline DamageCount truncate_everywhere(const std::vector<std::byte>& whole,
                                       const TryDecode& decodes) {
  DamageCount count;
  for (std::size_t size = 0; size < whole.size(); ++size)
    ++(decodes(std::span(whole).first(size)) ? count.accepted : count.refused);
  return count;
}

}  // namespace macula::codec
