// Owen-scrambled Sobol points in two dimensions. Every aligned block of 2^m indices, the first 2^m
// above all, is a (0, m, 2)-net: each of its elementary intervals of area 2^-m holds exactly one
// point. Pure functions. Sources: Sobol 1967 (first two dimensions); Owen 1995 (scrambling); Laine
// and Karras 2011 (hash that scrambles like a tree); Burley, "Practical Hash-based Owen
// Scrambling", JCGT 9(4) 2020 (its use, and the shuffled index).
#pragma once

#include <cstdint>

#include "server/sampling/batch.h"
#include "shared/math/hash.h"
#include "shared/math/vec.h"

namespace macula::sampling {

/// What makes one sequence out of a seed: the scramblings of its order and of both dimensions.
struct Scrambling {
  std::uint32_t order, x, y;

  constexpr explicit Scrambling(std::uint32_t seed) : order(), x(), y() {
    const std::uint64_t order_and_x = math::hash_mix(seed);
    order = static_cast<std::uint32_t>(order_and_x);
    x = static_cast<std::uint32_t>(order_and_x >> 32);
    y = static_cast<std::uint32_t>(math::hash_mix(order_and_x));
  }
};

/// Point `index` of the sequence chosen by `seed`, in [0, 1)^2. Different seeds give independent
/// scramblings and orders, so sequences pair up into higher dimensions without structure.
Vec2 sobol_owen_2d(std::uint32_t index, std::uint32_t seed);

/// Many sequences, one an item.
struct ScramblingBatch {
  IndexBatch order, x, y;

  void set(std::size_t i, const Scrambling& scrambling) {
    order.at[i] = scrambling.order, x.at[i] = scrambling.x, y.at[i] = scrambling.y;
  }
};
/// Point `index` of the first `count` sequences, with the bits of the function above.
void sobol_owen_2d(std::uint32_t index, const ScramblingBatch& sequences, std::size_t count,
                   Vec2Batch& points);

}  // namespace macula::sampling
