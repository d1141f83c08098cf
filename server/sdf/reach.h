// Where the distances of a program can be small: for each instruction a ball that holds all of its
// solid and how fast its value grows outside. Relative to the program's eye, in the scene's
// orientation, meters. Inside server/sdf and its tests.
#pragma once

#include <optional>
#include <vector>

#include "server/sdf/ball.h"
#include "server/sdf/program.h"

namespace macula::sdf {

/// A value is at least rate * (distance from the ball) outside of it.
struct Reach {
  Ball ball;
  float rate = 1.0F;  ///< in (0, 1]
};

/// By instruction. None for points, and for what has no end or stands behind a warp of space:
/// planes, repetition, mirrors, twists and bends.
std::vector<std::optional<Reach>> reaches_of(const Program& program);

}  // namespace macula::sdf
