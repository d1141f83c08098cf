// Reservoir: one light that stands for all light at a point, and the weights with which reservoirs
// of several points are combined. A point's target is the luminance that a light would bring it;
// for any light y, sum over the lists of E[f(y) W] is the point's light if W is the contribution
// weight. Sources: Bitterli et al. 2020 (reservoirs), Bitterli 2022, Eq. 9.10 (pairwise MIS).
#pragma once

#include <cstdint>

#include "shared/image/color.h"
#include "shared/math/vec.h"

namespace macula::kernels::lightcuts {

struct Reservoir {
  std::uint32_t light = 0;  ///< index into PlacedLights
  Vec2 u{0.0F};             ///< where on a triangle
  float weight = 0.0F;      ///< estimate of 1 / its probability; 0: it stands for darkness
  float confidence = 0.0F;  ///< frames' draws that went into it; 0: there is none
  /// Of all the light, over reflectance, that the reservoir was chosen from; luminance 1, or black.
  Rgb colour{0.0F};
};

/// What a light is worth at the point itself and at one neighbour: target x confidence of each.
struct PairedTargets {
  float own = 0.0F, other = 0.0F;  ///< >= 0
};
/// Pairwise MIS with `pairs` neighbours: the share of the point's own draw in a light, against one
/// neighbour; of the neighbour's draw in the same. All own shares and the neighbours' sum to 1 for
/// every light that the point's own draw could give.
inline float own_share(const PairedTargets& targets, int pairs) {
  const float other = static_cast<float>(pairs) * targets.other;
  const float sum = targets.own + other;
  return sum > 0.0F ? targets.own / sum / static_cast<float>(pairs) : 0.0F;
}
inline float other_share(const PairedTargets& targets, int pairs) {
  const float other = static_cast<float>(pairs) * targets.other;
  const float sum = targets.own + other;
  return sum > 0.0F ? other / sum / static_cast<float>(pairs) : 0.0F;
}

}  // namespace macula::kernels::lightcuts
