// What one thread traces with: kept between tiles for its memory. Inside server/sdf.
#pragma once

#include <vector>

#include "server/sdf/crossing.h"
#include "server/sdf/lane_queue.h"
#include "server/sdf/slabs.h"
#include "server/sdf/tracer.h"

namespace macula::sdf {

/// A cone of the pyramid, or what is left of it when it stopped.
struct ConeCell {
  float start = 0.0F;  ///< everything in the cell is free before it
  bool open = false;   ///< some wanted cell is in it and it may yet hit something
};

/// How a lane ended.
struct LaneResult {
  float at = 0.0F;     ///< of a hit: its mark, later the crossing
  float found = 0.0F;  ///< of a hit: the distance at its mark
  std::uint16_t steps = 0;
  LaneState state = LaneState::Miss;
};

/// Unit directions of the lanes of a block, by plane; grown but never shrunk.
class Directions {
 public:
  /// Room for this many; what was in it is lost.
  void resize(std::size_t count);
  /// Overwrites the tangents' directions: frames.h, `scene_from_view` a rotation.
  void point_along(std::size_t count, const Mat3& scene_from_view);
  Vec3 operator[](std::size_t i) const { return {x[i], y[i], z[i]}; }

  float *tangent_x = nullptr, *tangent_y = nullptr;
  float *x = nullptr, *y = nullptr, *z = nullptr;

 private:
  AlignedFloats block_;
};

struct TraceScratch {
  Registers registers;
  PagePool pool;
  Slabs tile_slabs, block_slabs;
  PointBatch points{};
  DistanceBatch distances{};
  Crossings crossings{};
  SurfaceBatch surfaces{};
  Directions corners, rays;            ///< of the block's cell corners, and of its samples
  std::vector<float> widths;           ///< of rays: hit distance at unit t
  std::vector<LaneResult> results;     ///< by lane
  std::vector<std::uint8_t> wanted;    ///< by cell of the block
  std::vector<ConeCell> outer, inner;  ///< two levels of the pyramid
  HitBlock block;
};

}  // namespace macula::sdf
