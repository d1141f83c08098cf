// PictureMemory: a picture over the frames of one view, so that samples at other places of a cell
// in every frame make one smooth picture and a head that moves sees none of them come and go. What
// was is found where the nearest surface around a cell lay, and held within what the cells around
// show now. Radiance is linear. Biased. Sources: Karis 2014 (temporal anti-aliasing), Salvi 2016
// (variance clipping).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "server/reconstruction/cell_areas.h"
#include "server/reconstruction/history_rows.h"
#include "server/reconstruction/row_warp.h"
#include "shared/image/color.h"

namespace macula::reconstruction {

/// One view as a frame left it.
struct PictureMemory {
  Pose world_from_view;
  PixelGrid grid;
  image::Plane<Texel> roots;  ///< square roots of radiance: read between cells, these keep contrast
  image::Plane<float> frames;  ///< that went into each cell
};

/// What of a picture has moved by itself since the last frame.
struct Movers {
  /// By cell: 0, nothing that moves, or 1 + an index of then_from_now.
  image::Plane<std::uint32_t> of;
  /// Where a point that is carried along was, world, meters.
  std::vector<Pose> then_from_now;
};

struct SteadyConfig {
  float most_frames = 8.0F;  ///< that the memory counts for at most, >= 1
  float deviations = 1.25F;  ///< of 3 x 3 cells now, that it may be off their mean
};

/// One frame's picture joined with what `last` remembers (none: nothing). Rows of one step may run
/// in any order, the second step after all of the first.
class PictureJoin {
 public:
  /// `fresh` and `inverse_depth` (1/m, 0: infinitely far) are of the view and grid in `now`. Refers
  /// to all.
  PictureJoin(const PictureMemory* last, const SteadyConfig& config, const image::Plane<Rgb>& fresh,
              const image::Plane<float>& inverse_depth, PictureMemory& now);

  /// Before any row: surfaces that moved bring what they showed along. Refers to `movers`, whose
  /// plane has the picture's size.
  void follow(const Movers& movers);
  void prepare_row(int y);
  /// Rows [begin, end) of `last` that join_row(y) reads, which also reads the prepared ones beside
  /// it. Optional; once for a row.
  struct Span {
    int begin = 0, end = 0;
  };
  Span locate_row(int y);
  void join_row(int y, std::span<Rgb> shown);

 private:
  struct Bounds {
    Vec3 low, high;
  };
  struct Row {
    std::vector<Texel> roots;
    RowReads reads;
  };
  RowPlaces places_of(int y) const;
  Row read(int y);
  float frames(const Row& row, int x, int y) const;
  Bounds around(int x, int y) const;
  struct Front {
    float inverse_depth = 0.0F;
    int x = 0, y = 0;
  };
  Front nearest(int x, int y) const;

  const PictureMemory* last_;
  const SteadyConfig& config_;
  const image::Plane<Rgb>& fresh_;
  const image::Plane<float>& inverse_depth_;
  PictureMemory& now_;
  image::Plane<Texel> fresh_roots_;
  image::Plane<float> anything_;  ///< inverse depths then, that agree with every other
  CellAreas areas_now_, areas_then_;
  std::optional<RowWarp> warp_;
  const Movers* movers_ = nullptr;
  std::vector<RowWarp::Eye> carried_;  ///< by mover: the eye that moved with it
  std::vector<RowPlaces> places_;      ///< by row, of those that were located
};

}  // namespace macula::reconstruction
