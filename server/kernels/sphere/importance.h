// Importance: which cells deserve the full level, decided anew every frame from eccentricity and
// the edges of the low level. Paper 2023 section 3.2.3 with the corrections that README.md lists.
// Pure functions.
#pragma once

#include <cstdint>

#include "server/kernels/sphere/config.h"

namespace macula::kernels::sphere {

/// Visual acuity at an eccentricity relative to the gaze, Eq. 1 with the exponent's sign corrected:
/// 0.90964 exp(-w / 2.9661 deg) + 0.00792, for w >= 0; in (0, 0.918].
double acuity(Degrees eccentricity);

/// Probability that a cell is traced at full level: 1 in the fovea, 0 beyond `outer`, between them
/// acuity times its share of an edge. `edge` in [0, 1].
double importance(Degrees eccentricity, float edge, const MaskConfig& config);

/// The random number a probability is held against; a cell is important where it is less. Blue
/// noise that moves by the golden ratio, or independent numbers for MaskRule::Literal.
float threshold(int x, int y, std::uint64_t frame, std::uint64_t seed, MaskRule rule);

}  // namespace macula::kernels::sphere
