// The inverted pyramid as Polychronakis, Koulieris and Mania (2023, section 3) print it, to compare
// with: pictures of 1/16, 1/4 and all of the cells, each ray of the first from the eye, each ray of
// the others from the least distance that the level before found in a neighbourhood of 1, 3 or 5
// cells a side. Plain steps, the whole program. It is not conservative: what is thinner than the
// gaps between coarse rays can be passed (Tracer's cones cannot).
// A level must be complete before the next begins; within a level tiles run on any threads, each
// with its own workspace.
#pragma once

#include <array>

#include "server/sdf/tracer.h"

namespace macula::sdf {

struct PaperOptions {
  int filter = 3;            ///< cells a side of the minimum filter: 1, 3 or 5
  int samples = 1;           ///< rays a cell of the last level
  float hit_pixels = 0.25F;  ///< of cells of the level's own size
  float hit_m = 0.0F;
  int max_steps = 256;
};

class PaperPyramid {
 public:
  static constexpr int kLevels = 3;

  /// `program` and `grid` must outlive the pyramid.
  static Result<PaperPyramid> create(const Program& program, const DMat3& scene_from_view,
                                     const PixelGrid& grid, const PaperOptions& options);

  /// The grid of a level, 0 the coarsest.
  const PixelGrid& grid(int level) const { return grids_[static_cast<std::size_t>(level)]; }
  /// A tile of at most kTileSide cells a side of that grid. `done` gets the blocks of the last
  /// level with their surfaces; of the others it is not called.
  TraceCounts trace(int level, const image::Rect& tile, TraceWorkspace& workspace,
                    const Tracer::Done& done);
  /// Marched distances of a level that is complete; far_m where nothing was hit.
  const image::Plane<float>& distances(int level) const {
    return distances_[static_cast<std::size_t>(level)];
  }

 private:
  PaperPyramid(const Program& program, const DMat3& scene_from_view, const PixelGrid& grid,
               const PaperOptions& options);
  float start_of(int level, int x, int y) const;
  TraceCounts trace_block(int level, const image::Rect& cells, TraceScratch& scratch);

  const Program* program_;
  Mat3 scene_from_view_;
  PaperOptions options_;
  std::array<PixelGrid, kLevels> grids_;
  std::array<image::Plane<float>, kLevels> distances_;
};

}  // namespace macula::sdf
