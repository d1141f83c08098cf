// BackwardWarp: where something that a view sees now lay in an earlier picture. What is seen must
// be known by its view depth now (a coarse level, a guess refined by steps); the caller holds what
// it finds against the earlier picture's own depth, so that disocclusions are noticed. Positions in
// meters, differences of poses in double. Immutable; safe from any thread.
#pragma once

#include <optional>

#include "shared/foveation/pixel_grid.h"
#include "shared/math/pose.h"

namespace macula::reconstruction {

class BackwardWarp {
 public:
  /// Refers to the grid of the earlier picture, which must outlive it.
  BackwardWarp(const Pose& world_from_now, const Pose& world_from_then, const PixelGrid& grid_then);

  struct Place {
    Vec2 cell{0.0F};       ///< continuous cell coordinates then; cell i's centre is i + 0.5
    float depth_m = 0.0F;  ///< view depth then; +infinity for what lies at infinity
  };
  /// Of the point at `tangent` and view depth `depth_m` > 0 now (+infinity: a direction). nullopt
  /// where it lay behind the eye or outside the grid.
  std::optional<Place> then(const Vec2& tangent, float depth_m) const;
  /// View depth now of a point at `tangent` and `depth_m` then; +infinity stays.
  float depth_now(const Vec2& tangent_then, float depth_then_m) const;
  const PixelGrid& grid_then() const { return grid_; }

 private:
  Mat3 then_from_now_rotation_;
  Vec3 then_from_now_origin_;  ///< the eye now, in the view frame then
  const PixelGrid& grid_;
};

}  // namespace macula::reconstruction
