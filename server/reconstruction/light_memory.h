// LightMemory: the mean of what earlier frames of one view found on the surfaces that it shows now,
// for light that chance estimates. Found again where the same surface lay, however the eye moved;
// held within what the last few frames say, so that lights may move. World, meters. Biased.
// Sources: Schied et al. 2017 (moments over frames), Zhdan 2021, "ReBLUR" (a fast history that
// bounds the slow one).
#pragma once

#include <optional>
#include <vector>

#include "server/reconstruction/atrous.h"
#include "server/reconstruction/cell_areas.h"
#include "server/reconstruction/row_warp.h"

namespace macula::reconstruction {

/// One view as a frame left it.
struct LightMemory {
  Pose world_from_view;
  PixelGrid grid;
  SurfacePlanes surfaces;
  LightPlanes mean;   ///< variance: of the mean's luminance
  WidePlane square;   ///< mean of the squared luminances that went in
  WidePlane recent;   ///< luminance, over the last few frames
  WidePlane fresh;    ///< samples of this frame in a cell, > 0 where there is a surface
  WidePlane samples;  ///< that went into the mean; 0: no surface

  /// What the next frame reads.
  std::vector<WidePlane*> all() {
    std::vector<WidePlane*> planes{&mean.r, &mean.g, &mean.b, &square, &recent, &samples};
    for (WidePlane* plane : surfaces.all()) planes.push_back(plane);
    return planes;
  }
  /// How many frames like this one the mean stands for.
  float frames(int x, int y) const { return samples.row(y)[x] / fresh.row(y)[x]; }
};

struct MemoryConfig {
  float most_frames = 24.0F;  ///< like this one, that the mean counts for at most, >= 1
  /// Samples that the mean counts for at most where a frame has fewer, >= 1: what is looked up anew
  /// in every frame is blurred by each, which costs more than chance where samples are many.
  float most_samples = 32.0F;
  float recent_frames = 4.0F;  ///< of the fast history, >= 1
  /// Standard deviations of the fast history around a cell that the mean may be off its mean.
  float deviations = 2.0F;
};

/// Joins the light of one frame with what `last` remembers (none: nothing), by samples; what wider
/// cells saw counts for less. `now` holds view, grid, surfaces, fresh samples, and in `mean` the
/// light of this frame with its luminance; when all three steps went
/// over all rows, one after the other, all of it is set. Rows of one step may run in any order. Of
/// planes that hold some rows only: joining reads rows of `last` that `locate_row` names; bounding
/// and judging read two rows to either side of what the step before left.
class MemoryJoin {
 public:
  /// Refers to all three.
  MemoryJoin(const LightMemory* last, const MemoryConfig& config, LightMemory& now);

  /// Rows of `last` that join_row(y) reads. Optional; once for a row.
  struct Span {
    int begin = 0, end = 0;
  };
  Span locate_row(int y);
  void join_row(int y);
  void bound_row(int y);  ///< by the fast history
  void judge_row(int y);  ///< variance

 private:
  struct Cell;
  RowPlaces places_of(int y) const;
  Cell recalled(const RowPlaces& places, int x, int y) const;
  bool shows_same(int x, int y, int then_x, int then_y) const;
  void join(int x, int y, const Cell& old);
  void bound(int x, int y);

  const LightMemory* last_;
  const MemoryConfig& config_;
  LightMemory& now_;
  std::optional<RowWarp> warp_;
  CellAreas areas_now_, areas_then_;
  std::vector<RowPlaces> places_;  ///< by row, of those that were located
  Spread around_mean_, around_recent_;
};

}  // namespace macula::reconstruction
