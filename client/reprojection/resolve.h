// From places in the source grid to colours. Internal to this room and its twin, display/gl; one
// thread.
#pragma once

#include <cstdint>
#include <span>

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
/// Where cells are at most `widest_px` display pixels wide, and high.
FineRanges narrow_cells(const PixelGrid& grid, const foveation::Display& display, float widest_px);

/// Fragments of a row, [first, end).
struct FragmentSpan {
  int first, end;
};
/// A stretch of a row of `count` fragments that holds all that are drawn from within `ranges`; it
/// begins and ends at multiples of sixteen or at the row's end.
FragmentSpan span_within(const FragmentRow& fragments, int count, const FineRanges& ranges);

/// Colours between cell centres; the grid's outermost cells go on beyond its edge; black where
/// nothing is drawn. Rows from kSecondLayerRow on are those of the second layer. At a cell's centre
/// the result is that cell's colour to the bit, whatever the filter.
class Resolver {
 public:
  Resolver(const SourceView& source, const foveation::Display& display, WarpOptions::Filter filter);
  /// The pixels of `out`, those of a row from pixel `first` on.
  void resolve_row(const FragmentRow& fragments, int first, std::span<Rgb8> out) const;
  /// As four bytes each, red in the lowest, by Bilinear; room for a whole vector beyond `count`.
  void resolve_words(const FragmentRow& fragments, int count, std::uint32_t* words) const;

 private:
  const image::Plane<Rgb8>& source_;
  const image::Plane<Rgb8>& hidden_;  ///< the second layer's; the first's again where there is none
  const FineRanges fine_;
};

}  // namespace macula::reprojection
