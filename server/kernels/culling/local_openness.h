// Bidirectional local-space occlusion (section 3.4): whether a virtual light and a point are likely
// to see each other, guessed from what the lamps see around both of them. A place is asked for 26
// directions; each is the mean of what eight positions near it, in a cone about the direction,
// tell: in front of what a lamp's depth map holds there, at a surface, or behind one. World,
// meters. It says "open" for much that is hidden: light that is hidden from lamps is what it can
// see. Where the paper gives no figure: maps of 64 x 64 directions, cones of 25 degrees, positions
// within 2 % of half the extent of all lights. Lamps that are neither points nor spots tell
// nothing; of several, the one that sees a position best counts.
#pragma once

#include <array>
#include <vector>

#include "server/kernels/scene_frame.h"
#include "server/scheduling/tile_scheduler.h"

namespace macula::kernels::culling {

/// Share that is open, [0, 1], by direction.
class Openness {
 public:
  float towards(const Vec3& direction) const { return share_[index_of(direction)]; }

 private:
  friend class LampMaps;
  static constexpr int kDirections = 27;  ///< a 3 x 3 x 3 cube's cells, its middle unused
  static std::size_t index_of(const Vec3& direction);
  std::array<float, kDirections> share_{};
};

/// What every lamp sees first, in all directions.
class LampMaps {
 public:
  /// `extent_m`: the diameter that depths are measured in, and twice the radius of what "near" is a
  /// share of; > 0.
  LampMaps(const SceneFrame& scene, float extent_m, scheduling::TileScheduler& scheduler);

  /// Everything is open where no lamp has a map.
  Openness around(const Vec3& place, const Vec3& normal) const;
  std::uint64_t rays() const { return rays_; }

 private:
  struct Map {
    Vec3 lamp{0.0F};
    std::vector<float> distance_m;  ///< octahedral, kSide x kSide
  };
  float seen(const Vec3& position) const;

  std::vector<Map> maps_;
  float extent_m_;
  std::uint64_t rays_ = 0;
};

}  // namespace macula::kernels::culling
