// Owen-scrambled Sobol points in two dimensions. Every aligned block of 2^m indices, the first 2^m
// above all, is a (0, m, 2)-net: each of its elementary intervals of area 2^-m holds exactly one
// point. Pure functions. Sources: Sobol 1967 (first two dimensions); Owen 1995 (scrambling); Laine
// and Karras 2011 (hash that scrambles like a tree); Burley, "Practical Hash-based Owen
// Scrambling", JCGT 9(4) 2020 (its use, and the shuffled index).
#pragma once

#include <cstdint>

#include "shared/math/vec.h"

namespace macula::sampling {

/// Point `index` of the sequence chosen by `seed`, in [0, 1)^2. Different seeds give independent
/// scramblings and orders, so sequences pair up into higher dimensions without structure.
Vec2 sobol_owen_2d(std::uint32_t index, std::uint32_t seed);

}  // namespace macula::sampling
