// From places in the source grid to colours. Internal to this room and its twin, display/gl; one
// thread.
#pragma once

#include "client/reprojection/doubled_rows.h"
#include "client/reprojection/fragments.h"
#include "client/reprojection/warp.h"

namespace macula::reprojection {

/// Cell coordinates of one axis; empty where first > last.
struct CellRange {
  float first = 0.0F, last = -1.0F;
};
/// Where a filter takes CatmullRom.
struct FineRanges {
  CellRange u, v;
};
FineRanges fine_ranges(const PixelGrid& grid, const foveation::Display& display,
                       WarpOptions::Filter filter);

/// Colours between cell centres; the grid's outermost cells go on beyond its edge; black where
/// nothing is drawn. Rows from kSecondLayerRow on are those of the second layer. At a cell's centre
/// the result is that cell's colour to the bit, whatever the filter.
class Resolver {
 public:
  Resolver(const SourceView& source, const foveation::Display& display, WarpOptions::Filter filter);
  /// Row `y` of `out`, which has the whole picture's size.
  void resolve_row(const FragmentRow& fragments, int y, image::Plane<Rgb8>& out) const;

 private:
  const image::Plane<Rgb8>& source_;
  const image::Plane<Rgb8>& hidden_;  ///< the second layer's; the first's again where there is none
  const FineRanges fine_;
};

}  // namespace macula::reprojection
