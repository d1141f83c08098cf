// The cubic that draws between samples: it runs through the two in the middle of four and has the
// slopes between their neighbours there. Pure functions.
// Source: Catmull and Rom, "A class of local interpolating splines", 1974.
#pragma once

#include <array>

#include "shared/image/color.h"

namespace macula::kernels::sphere {

/// Weights of four samples for a place at `share` in [0, 1] of the way from the second to the
/// third, which are `gap` > 0 apart; `first_to_third` and `second_to_fourth` apart are those whose
/// slope counts. Any unit. What is affine stays so on unequal steps.
inline std::array<float, 4> cubic_weights(float share, float gap, float first_to_third,
                                          float second_to_fourth) {
  const float s = share;
  const float low = s * (1.0F - s) * (1.0F - s) * gap / first_to_third;
  const float high = s * s * (s - 1.0F) * gap / second_to_fourth;
  const float third = s * s * (3.0F - 2.0F * s);
  return {-low, 1.0F - third - high, third + low, high};
}

/// `color`, but no brighter or darker than the four samples around its place, channel by channel.
inline Rgb held_within(const Rgb& color, const Rgb& a, const Rgb& b, const Rgb& c, const Rgb& d) {
  return glm::clamp(color, glm::min(glm::min(a, b), glm::min(c, d)),
                    glm::max(glm::max(a, b), glm::max(c, d)));
}

}  // namespace macula::kernels::sphere
