// What one thread traces with: kept between tiles for its memory. Inside server/sdf.
#pragma once

#include <vector>

#include "server/sdf/march.h"
#include "server/sdf/slabs.h"
#include "server/sdf/tracer.h"

namespace macula::sdf {

/// A cone of the pyramid, or what is left of it when it stopped.
struct ConeCell {
  float start = 0.0F;  ///< everything in the cell is free before it
  bool open = false;   ///< some wanted cell is in it and it may yet hit something
};

struct TraceScratch {
  Registers registers;
  Slabs tile_slabs, block_slabs;
  Chunk chunk{};
  PointBatch points{};
  DistanceBatch distances{};
  SurfaceBatch surfaces{};
  std::vector<Lane> lanes;
  std::vector<std::uint32_t> cells;    ///< which cell of its level a cone's lane is
  std::vector<Vec3> corners;           ///< unit directions of the block's cell corners
  std::vector<std::uint8_t> wanted;    ///< by cell of the block
  std::vector<ConeCell> outer, inner;  ///< two levels of the pyramid
  HitBlock block;
};

}  // namespace macula::sdf
