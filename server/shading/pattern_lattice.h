// Numbers that both forms of the patterns share. Inside server/shading.
#pragma once

#include <cstdint>

namespace macula::shading {

/// Share of a brick's height that a joint takes.
inline constexpr float kJoint = 0.08F;
/// Odd factors of the lattice's axes, and of the rounds that mix their sum (after Wang).
inline constexpr std::uint32_t kLatticeX = 0x9E3779B1U, kLatticeY = 0x85EBCA77U,
                               kLatticeZ = 0xC2B2AE3DU;
inline constexpr std::uint32_t kLatticeMix[2] = {0x2C1B3C6DU, 0x297A2D39U};

}  // namespace macula::shading
